//! Divides networks into runs. Two runs share no rows, so several threads can read them.

use crate::scene::assembly::Assembly;
use crate::scene::group::Groups;
use crate::scene::rows::{BodyRow, Cut, ElementRow};
use crate::threads;
use std::mem::take;

/// Number of elements in networks from which on several threads are worth their start-up time, to read or to solve them. Pinned
/// by the benchmark `own/isolated/turning`.
pub(crate) const WORTH_SHARING: usize = 256;

/// Indices into the rows of elements and of bodies.
type Places = [usize; 2];

/// Division of networks and rows into runs.
#[derive(Default)]
pub(crate) struct Runs {
    /// End of each run.
    ends: Vec<End>,
    /// For each network, from the last to the first: the least rows of this network and all later ones.
    firsts: Vec<Places>,
}

/// End of a run: index after its last network, and after its last rows.
#[derive(Clone, Copy)]
struct End {
    network: usize,
    rows: Places,
}

impl Runs {
    /// Finds the runs. Networks whose rows interleave are in the same run. The number of runs does not change the result.
    pub(crate) fn find(&mut self, assemblies: &[Assembly], groups: &Groups) {
        self.ends.clear();
        let members = |assembly: &Assembly| groups.members(&groups.list()[assembly.group]);
        let load = |assembly: &Assembly| members(assembly).elements.len();
        let all: usize = assemblies.iter().map(load).sum();
        let threads = threads::count();
        if threads > 1 && assemblies.len() > 1 && all >= WORTH_SHARING {
            self.firsts.clear();
            let mut first = [usize::MAX; 2];
            self.firsts.extend(assemblies.iter().rev().map(|assembly| {
                let members = members(assembly);
                let rows = [members.elements, members.bodies];
                let least = rows.map(|rows| rows.iter().min());
                for (first, least) in first.iter_mut().zip(least) {
                    *first = least.map_or(*first, |least| (*first).min(*least as usize));
                }
                first
            }));
            let (mut last, mut waiting) = ([0; 2], 0);
            for (at, assembly) in assemblies.iter().enumerate() {
                let members = members(assembly);
                for (last, rows) in last.iter_mut().zip([members.elements, members.bodies]) {
                    *last = rows
                        .iter()
                        .fold(*last, |last, row| last.max(*row as usize + 1));
                }
                waiting += members.elements.len();
                let Some(next) = self.firsts.iter().rev().nth(at + 1) else {
                    break;
                };
                let apart = last[0] <= next[0] && last[1] <= next[1];
                if apart && waiting >= all.div_ceil(threads::PER_THREAD * threads) {
                    waiting = 0;
                    self.ends.push(End {
                        network: at + 1,
                        rows: last,
                    });
                }
            }
        }
        self.ends.push(End {
            network: assemblies.len(),
            rows: [usize::MAX; 2],
        });
    }

    /// Splits networks and rows at the ends of the runs.
    pub(crate) fn cut<'a>(
        &'a self,
        mut assemblies: &'a mut [Assembly],
        mut elements: Cut<'a, ElementRow>,
        mut bodies: Cut<'a, BodyRow>,
    ) -> impl ExactSizeIterator<Item = (&'a mut [Assembly], Cut<'a, ElementRow>, Cut<'a, BodyRow>)>
    {
        let mut first = 0;
        self.ends.iter().map(move |end| {
            let (own, others) = take(&mut assemblies).split_at_mut(end.network - first);
            assemblies = others;
            first = end.network;
            let [e, b] = end.rows;
            (own, elements.take_before(e), bodies.take_before(b))
        })
    }
}
