//! Whether a world is sound.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use aureole_math::{Bounds3, Point3};

use crate::bvh::{Census, Layers, census};
use crate::index::Index;
use crate::world::Object;
use crate::{Stats, World};

/// What is wrong with a structure. None of these can be made by a builder; tests look for them after each.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Defect {
    /// A box reaches out of the box of its parent.
    #[error("a child reaches out of node {node}")]
    Escapes {
        /// The parent.
        node: usize,
    },
    /// Nodes that are reached twice or never.
    #[error("{reached} nodes are reached of {nodes}")]
    Nodes {
        /// How many are reached.
        reached: usize,
        /// How many there are.
        nodes: usize,
    },
    /// More levels than a walk has room for.
    #[error("deeper than {limit} levels")]
    TooDeep {
        /// The most there may be.
        limit: usize,
    },
    /// A group of primitives that is in no leaf, or in several.
    #[error("group {group} is in {leaves} leaves")]
    Group {
        /// The group.
        group: usize,
        /// How many leaves hold it.
        leaves: usize,
    },
    /// A primitive that is in no leaf.
    #[error("primitive {primitive} is in no leaf")]
    Lost {
        /// The primitive, counted through the level.
        primitive: usize,
    },
    /// A primitive that reaches out of its leaves.
    #[error("primitive {primitive} reaches out of its leaves")]
    Uncovered {
        /// The primitive, counted through the level.
        primitive: usize,
    },
    /// A number beyond the primitives there are.
    #[error("a leaf names primitive {primitive} of {count}")]
    Unknown {
        /// The primitive, counted through the level.
        primitive: usize,
        /// How many there are.
        count: usize,
    },
}

/// A primitive in a leaf's group, and the box around it if that is known.
pub(crate) type Member = (u32, Option<Bounds3>);

/// Tells the members of a group.
type Members<'a> = dyn Fn(usize, &mut dyn FnMut(Member)) + 'a;

/// Checks a structure over `count` primitives, of which `members` tells those of a group.
pub(crate) fn check(
    index: &Index,
    groups: usize,
    count: usize,
    members: &Members<'_>,
) -> Result<Stats, Defect> {
    let mut seen = Seen { covered: vec![Bounds3::EMPTY; count], found: vec![false; count], references: 0 };
    let mut leaves = vec![0; groups];
    let mut leaf = |bounds: Bounds3, first: usize, number: usize| {
        for group in first..first + number {
            *leaves.get_mut(group).ok_or(Defect::Group { group, leaves: 1 })? += 1;
            seen.group(group, Some(bounds), members)?;
        }
        Ok(())
    };
    let census = match index {
        Index::Wide(bvh) => census(&Layers::<_, 8>::exact(bvh), &mut leaf)?,
        Index::Sixteen(bvh) => census(&Layers::<_, 16>::exact(bvh), &mut leaf)?,
        Index::Compact(bvh) => census(&Layers::<_, 8>::rounded(bvh), &mut leaf)?,
        Index::Binary(tree) => census(tree, &mut leaf)?,
        Index::List { .. } | Index::Grid(_) => Census::default(),
    };
    match index {
        Index::List { .. } => {
            for (group, leaves) in leaves.iter_mut().enumerate() {
                *leaves = 1;
                seen.group(group, None, members)?;
            }
        }
        Index::Grid(grid) => {
            let mut foreign = None;
            grid.for_each_object(&mut |group| match leaves.get_mut(group as usize) {
                Some(leaves) => *leaves = 1,
                None => foreign = Some(group as usize),
            });
            if let Some(group) = foreign {
                return Err(Defect::Group { group, leaves: 1 });
            }
            for group in 0..groups {
                seen.group(group, None, members)?;
            }
        }
        _ => {}
    }
    if let Some(group) = leaves.iter().position(|&leaves| leaves != 1) {
        return Err(Defect::Group { group, leaves: leaves[group] });
    }
    if let Some(primitive) = seen.found.iter().position(|found| !found) {
        return Err(Defect::Lost { primitive });
    }
    // All the leaves of a primitive together must reach as far as it does.
    for group in 0..groups {
        let mut result = Ok(());
        members(group, &mut |(id, own)| {
            let (primitive, slack) = (id as usize, 1e-5);
            let covered = seen.covered[primitive];
            let holds = |own: Bounds3| {
                let reach = own.diagonal().abs().max_element() + own.max.to_vector().abs().max_element();
                (0..3).all(|a| {
                    covered.min[a] <= own.min[a] + slack * reach
                        && covered.max[a] >= own.max[a] - slack * reach
                })
            };
            if !covered.is_empty() && own.is_some_and(|own| !holds(own)) {
                result = Err(Defect::Uncovered { primitive });
            }
        });
        result?;
    }
    let plain = index.stats();
    Ok(match index {
        Index::Wide(_) | Index::Sixteen(_) | Index::Compact(_) | Index::Binary(_) => Stats {
            sah_cost: census.sah_cost,
            built_sah_cost: match index {
                Index::Sixteen(_) | Index::Compact(_) => census.sah_cost, // built anew, never fitted
                _ => plain.sah_cost,
            },
            nodes: census.nodes,
            leaves: census.leaves,
            children: census.children,
            depth: census.depth,
            primitives: count,
            references: seen.references,
            bytes: plain.bytes,
        },
        Index::Grid(_) => Stats { primitives: count, ..plain },
        Index::List { .. } => Stats { primitives: count, references: count, ..plain },
    })
}

/// What was met in leaves.
struct Seen {
    /// The box around all leaves of each primitive.
    covered: Vec<Bounds3>,
    found: Vec<bool>,
    references: usize,
}

impl Seen {
    fn group(&mut self, group: usize, leaf: Option<Bounds3>, members: &Members<'_>) -> Result<(), Defect> {
        let mut result = Ok(());
        members(group, &mut |(id, _)| {
            let primitive = id as usize;
            let Some(found) = self.found.get_mut(primitive) else {
                result = Err(Defect::Unknown { primitive, count: self.found.len() });
                return;
            };
            *found = true;
            self.references += 1;
            if let Some(leaf) = leaf {
                self.covered[primitive] = self.covered[primitive].union(leaf);
            }
        });
        result
    }
}

impl World {
    /// Checks this level's structures, and tells what they look like: every primitive is in leaves that reach as far as it does,
    /// every box holds its children, every node is reached once, and no way is longer than a walk has room for. The boxes of
    /// user shapes and instances, which the world does not keep, are not compared with their leaves.
    ///
    /// Takes about as long as a fast build.
    ///
    /// # Errors
    /// What is wrong, if anything is: that would be a fault of this crate.
    pub fn validate(&self) -> Result<Stats, Defect> {
        let triangles = |group: usize, visit: &mut dyn FnMut(Member)| {
            let mut made = None;
            let block = self.blocks.get(group, &mut made);
            for (lane, &id) in block.ids.iter().enumerate().take_while(|(_, id)| **id != u32::MAX) {
                let corners = block.vertices(self.config.accuracy, lane);
                visit((id, Some(Bounds3::around(corners.map(Point3::from)))));
            }
        };
        let mut stats = check(&self.triangles, self.blocks.len(), self.triangle_count(), &triangles)?;
        stats.bytes += self.blocks.bytes();
        for moving in &self.moving {
            stats = stats.merged(moving.validate()?);
        }
        let objects = |group: usize, visit: &mut dyn FnMut(Member)| visit((group as u32, None));
        let count = self.objects.len();
        let others = check(&self.object_index, count, count, &objects)?;
        Ok(stats.merged(Stats { bytes: others.bytes + size_of_val(&self.objects[..]), ..others }))
    }

    /// Figures about the structures of this level: those of [`validate`](Self::validate), or none where it finds a defect.
    pub fn stats(&self) -> Stats {
        self.validate().unwrap_or_default()
    }

    /// Figures about this level and all that are instanced in it, each once, by their tags: the lowest first.
    pub fn stats_of_levels(&self) -> Vec<(u32, Stats)> {
        let mut levels = BTreeMap::from([(self.tag, self)]);
        let mut waiting = vec![self];
        while let Some(world) = waiting.pop() {
            for object in &world.objects {
                if let Object::Instance { level, .. } | Object::MovingInstance { level, .. } = object
                    && let Entry::Vacant(place) = levels.entry(level.tag)
                {
                    place.insert(level);
                    waiting.push(level);
                }
            }
        }
        levels.into_iter().map(|(tag, level)| (tag, level.stats())).collect()
    }
}
