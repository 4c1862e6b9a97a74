//! How a line is led through the tree.

use super::{Bsp, DEPTH, Line, Node, Places, Search};

/// What is left for later: a node, what lies in the plane before it, and the part of the line in the node.
#[derive(Clone, Copy)]
struct Later {
    node: u32,
    within: Places,
    first: f32,
    last: f32,
}

pub(super) fn visit(bsp: &Bsp, line: &Line, search: &mut impl Search) {
    let test = |[from, to]: Places, search: &mut _| Search::test(search, from as usize..to as usize);
    let (first, last) = bsp.bounds.clip(line, line.t_min, search.end());
    let nothing = Later { node: 0, within: [0, 0], first, last };
    let (mut now, mut later, mut count) = (nothing, [nothing; DEPTH], 0);
    loop {
        if now.first <= now.last && now.first <= search.end() {
            search.step();
            test(now.within, search);
            match bsp.nodes[now.node as usize] {
                Node::Leaf(places) => test(places, search),
                Node::Split { plane, within, children: [behind, before] } => {
                    let (is_backwards, far_begins, near_ends) = plane.cut(line, bsp.reach);
                    let [near, far] = if is_backwards { [before, behind] } else { [behind, before] };
                    let (far_first, near_last) = (now.first.max(far_begins), now.last.min(near_ends));
                    let has_near = now.first <= near_last;
                    let beyond = Later {
                        node: far,
                        within: if has_near { within } else { [0, 0] },
                        first: far_first,
                        last: now.last,
                    };
                    now = if has_near {
                        later[count] = beyond;
                        count += 1;
                        Later { node: near, within: [0, 0], first: now.first, last: near_last }
                    } else {
                        beyond
                    };
                    continue;
                }
            }
        }
        if count == 0 {
            return;
        }
        count -= 1;
        now = later[count];
    }
}
