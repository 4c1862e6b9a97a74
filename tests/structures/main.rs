//! The structures that leafwalk is compared with.

mod same_answer;
