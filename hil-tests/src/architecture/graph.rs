//! Who uses whom, and the circles in it.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;

/// Named things and who of them uses whom, each use with the first reason found.
#[derive(Debug, Default)]
pub struct Graph {
    names: Vec<String>,
    edges: BTreeMap<(usize, usize), String>,
}

/// Steps that lead back to where they began.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Circle {
    /// From, to, because.
    pub steps: Vec<(String, String, String)>,
}

impl fmt::Display for Circle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (from, to, because) in &self.steps {
            writeln!(f, "{from} -> {to} ({because})")?;
        }
        Ok(())
    }
}

impl Graph {
    /// Names without any use.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        Self {
            names: names.into_iter().collect(),
            edges: BTreeMap::new(),
        }
    }

    /// Adds a use. Nothing uses itself.
    pub fn connect(&mut self, from: usize, to: usize, because: String) {
        if from != to {
            self.edges.entry((from, to)).or_insert(because);
        }
    }

    /// All uses: from, to, because.
    pub fn edges(&self) -> impl Iterator<Item = (&str, &str, &str)> {
        let name = |place: usize| self.names[place].as_str();
        let edges = self.edges.iter();
        edges.map(move |((from, to), because)| (name(*from), name(*to), because.as_str()))
    }

    /// The shortest circle of each knot, where a knot is a set of names that all reach each other.
    #[must_use]
    pub fn circles(&self) -> Vec<Circle> {
        let knots = self.knots();
        let shortest = knots.iter().filter_map(|knot| {
            let circles = knot.iter().filter_map(|name| self.way_back(*name));
            circles.min_by_key(Vec::len)
        });
        shortest.map(|way| self.circle(&way)).collect()
    }

    /// All uses within knots: what there is to choose from when a circle is to be opened.
    #[must_use]
    pub fn knotted(&self) -> Vec<Circle> {
        let within = |knot: &BTreeSet<usize>| {
            let edges = self.edges.keys();
            let inside = edges.filter(|(from, to)| knot.contains(from) && knot.contains(to));
            Circle {
                steps: inside.map(|(from, to)| self.step(*from, *to)).collect(),
            }
        };
        self.knots().iter().map(within).collect()
    }

    fn knots(&self) -> Vec<BTreeSet<usize>> {
        let reached: Vec<BTreeSet<usize>> =
            (0..self.names.len()).map(|name| self.reach(name)).collect();
        let knot = |name: usize| -> BTreeSet<usize> {
            let there = reached[name].iter().copied();
            there
                .filter(|other| reached[*other].contains(&name))
                .collect()
        };
        let knots: BTreeSet<BTreeSet<usize>> = (0..self.names.len()).map(knot).collect();
        knots.into_iter().filter(|knot| !knot.is_empty()).collect()
    }

    fn uses(&self, from: usize) -> impl Iterator<Item = usize> {
        let edges = self.edges.range((from, 0)..(from + 1, 0));
        edges.map(|((_, to), _)| *to)
    }

    /// What a name reaches in at least one step.
    fn reach(&self, from: usize) -> BTreeSet<usize> {
        let mut reached = BTreeSet::new();
        let mut open: Vec<usize> = self.uses(from).collect();
        while let Some(name) = open.pop() {
            if reached.insert(name) {
                open.extend(self.uses(name));
            }
        }
        reached
    }

    /// The shortest way from a name back to itself.
    fn way_back(&self, start: usize) -> Option<Vec<usize>> {
        let mut before: BTreeMap<usize, usize> = BTreeMap::new();
        let mut open = VecDeque::from([start]);
        while let Some(name) = open.pop_front() {
            for next in self.uses(name) {
                if let std::collections::btree_map::Entry::Vacant(place) = before.entry(next) {
                    place.insert(name);
                    open.push_back(next);
                }
            }
        }
        let mut way = vec![start];
        let mut name = *before.get(&start)?;
        while name != start {
            way.push(name);
            name = before[&name];
        }
        way.push(start);
        way.reverse();
        Some(way)
    }

    fn circle(&self, way: &[usize]) -> Circle {
        Circle {
            steps: way
                .windows(2)
                .map(|pair| self.step(pair[0], pair[1]))
                .collect(),
        }
    }

    fn step(&self, from: usize, to: usize) -> (String, String, String) {
        let because = self.edges[&(from, to)].clone();
        (self.names[from].clone(), self.names[to].clone(), because)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(edges: &[(usize, usize)]) -> Graph {
        let mut graph = Graph::new(["a", "b", "c", "d", "e"].map(String::from));
        for (from, to) in edges {
            graph.connect(*from, *to, "so".into());
        }
        graph
    }

    #[test]
    fn arrows_in_one_direction_make_no_circle() {
        let down = graph(&[(0, 1), (0, 2), (1, 2), (2, 3), (4, 4)]);
        assert_eq!(down.circles(), []);
    }

    #[test]
    fn every_knot_shows_its_shortest_circle_and_all_its_uses() {
        let knots = graph(&[(0, 1), (1, 2), (2, 0), (2, 1), (3, 4), (4, 3), (0, 4)]);
        let shown: Vec<String> = knots.circles().iter().map(Circle::to_string).collect();
        assert_eq!(
            shown,
            ["b -> c (so)\nc -> b (so)\n", "d -> e (so)\ne -> d (so)\n"]
        );
        let sizes: Vec<usize> = knots.knotted().iter().map(|all| all.steps.len()).collect();
        assert_eq!(sizes, [4, 2]);
    }
}
