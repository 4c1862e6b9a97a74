//! How many answers were right, and how sure that makes one of how many are.

use core::ops::AddAssign;

use super::Verdict;

/// The 97.5 % quantile of the normal distribution: 95 % of it lie between this and its negative.
const QUANTILE: f64 = 1.959_964;

/// Answers by their verdicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// All answers.
    pub rays: u64,
    /// See [`Verdict::Neighbour`].
    pub neighbours: u64,
    /// See [`Verdict::Off`].
    pub off: u64,
    /// See [`Verdict::Wrong`].
    pub wrong: u64,
    /// See [`Verdict::Missed`].
    pub missed: u64,
    /// See [`Verdict::False`].
    pub not_there: u64,
}

impl Counts {
    /// Counts an answer.
    pub fn add(&mut self, verdict: Verdict) {
        self.rays += 1;
        match verdict {
            Verdict::Right => {}
            Verdict::Neighbour => self.neighbours += 1,
            Verdict::Off => self.off += 1,
            Verdict::Wrong => self.wrong += 1,
            Verdict::Missed => self.missed += 1,
            Verdict::False => self.not_there += 1,
        }
    }

    /// The counts of many answers.
    pub fn of(verdicts: impl Iterator<Item = Verdict>) -> Self {
        let mut counts = Self::default();
        verdicts.for_each(|verdict| counts.add(verdict));
        counts
    }

    /// All that are not the truth: another surface or none, one where there is none, or a t that is off.
    pub fn faults(&self) -> u64 {
        self.off + self.wrong + self.missed + self.not_there
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.neighbours += other.neighbours;
        self.off += other.off;
        self.wrong += other.wrong;
        self.missed += other.missed;
        self.not_there += other.not_there;
    }
}

/// `count` of `rays`, per million rays: the share that was found, and between which two the true one lies with 95 %
/// confidence (E. B. Wilson, "Probable Inference, the Law of Succession, and Statistical Inference", 1927).
pub fn per_million(count: u64, rays: u64) -> [f64; 3] {
    let (n, share) = (rays as f64, count as f64 / rays as f64);
    let square = QUANTILE * QUANTILE;
    let middle = (share + 0.5 * square / n) / (1.0 + square / n);
    let spread = QUANTILE / (1.0 + square / n) * (share * (1.0 - share) / n + 0.25 * square / (n * n)).sqrt();
    // A share of 0 has the lower end 0, rounding or not.
    [share, (middle - spread).max(0.0), middle + spread].map(|share| 1e6 * share)
}

#[cfg(test)]
mod tests {
    use super::per_million;

    #[test]
    fn intervals_are_those_of_the_literature() {
        // R. G. Newcombe, "Two-sided confidence intervals for the single proportion", 1998, table I, method 3.
        for (count, rays, low, high) in [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)] {
            let [share, found_low, found_high] = per_million(count, rays).map(|x| 1e-6 * x);
            assert_eq!(share, count as f64 / rays as f64);
            assert!((found_low - low).abs() < 1e-4 && (found_high - high).abs() < 1e-4, "{found_low} {found_high}");
        }
    }
}
