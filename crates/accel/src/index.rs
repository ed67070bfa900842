//! The structures behind one face: each finds the packed things that a ray may meet.

use aureole_math::{Bounds3, Ray};

use crate::big::Big;
use crate::binary;
use crate::bvh::{self, Below, BinaryNode, BinaryTree, Bvh, Bvh8, CompactNode, Leaf, Node16, VisitLeaf};
use crate::grid::Grid;
use crate::simd::{self, Kernel, Simd};
use crate::things::Things;
use crate::{Config, Layout, Stats, Structure, Width};

/// A structure over things that its owner has packed in groups.
#[derive(Clone, Debug)]
pub(crate) enum Index {
    /// All of them.
    List {
        bounds: Bounds3,
        groups: usize,
    },
    Grid(Grid),
    Binary(BinaryTree),
    Wide(Bvh8),
    Sixteen(Bvh<Node16>),
    Compact(Bvh<CompactNode>),
}

/// A structure, and how its owner must pack things.
pub(crate) struct Indexed {
    pub index: Index,
    /// Things in the order of the groups.
    pub order: Big<u32>,
    /// Each group's first in `order` and how many it has.
    pub groups: Vec<[u32; 2]>,
}

impl Index {
    /// Builds the structure over `count` things. A group has up to `lanes` of them.
    pub(crate) fn build(count: usize, things: &impl Things, lanes: usize, config: &Config) -> Indexed {
        let all = || Big::from((0..count as u32).collect::<Vec<_>>());
        match config.structure {
            Structure::List => {
                let box_around = (0..count as u32).fold(Bounds3::EMPTY, |b, i| b.union(things.bounds(i)));
                let groups: Vec<_> = (0..count as u32)
                    .step_by(lanes)
                    .map(|first| [first, (count as u32 - first).min(lanes as u32)])
                    .collect();
                Indexed {
                    index: Self::List { bounds: box_around, groups: groups.len() },
                    order: all(),
                    groups,
                }
            }
            Structure::Grid => {
                let grid = Grid::build(count, things, &config.grid);
                Indexed {
                    index: Self::Grid(grid),
                    order: all(),
                    groups: (0..count as u32).map(|i| [i, 1]).collect(),
                }
            }
            Structure::Binary => {
                let (mut tree, mut groups) = (bvh::build_binary(count, things, lanes), Vec::new());
                for node in tree.nodes.iter_mut() {
                    if let Below::Items { first, count } = node.below() {
                        *node = BinaryNode::leaf(node.bounds, groups.len(), 1);
                        groups.push([first as u32, count as u32]);
                    }
                }
                let order = std::mem::take(&mut tree.order);
                tree.built_sah_cost = tree.stats().sah_cost;
                Indexed { index: Self::Binary(tree), order, groups }
            }
            Structure::Hierarchy => {
                let built = bvh::build(count, things, lanes, config);
                let index = match (config.layout, config.width) {
                    (Layout::Compact, _) => Self::Compact(Bvh::compacted(&built.bvh)),
                    (Layout::Fast, Width::Sixteen) => Self::Sixteen(Bvh::widened(&built.bvh)),
                    (Layout::Fast, Width::Auto | Width::Eight) => Self::Wide(built.bvh),
                };
                Indexed { index, order: built.order, groups: built.groups }
            }
        }
    }

    /// Visits what a ray may meet before `t_max`.
    #[inline(always)]
    pub(crate) fn walk<S: Simd, V: VisitLeaf>(&self, ray: &Ray, t_max: f32, visitor: &mut V) {
        match self {
            Self::Wide(bvh) => bvh.walk::<8, S, V>(ray, t_max, visitor),
            Self::Sixteen(bvh) => bvh.walk::<16, S, V>(ray, t_max, visitor),
            Self::Compact(bvh) => bvh.walk::<8, S, V>(ray, t_max, visitor),
            Self::List { groups, .. } => {
                visitor.visit::<S>(0, *groups);
            }
            Self::Grid(grid) => grid.walk::<S, V>(ray, t_max, visitor),
            Self::Binary(tree) => binary::walk::<S, V>(tree, ray, t_max, visitor),
        }
    }

    /// The same walk, compiled once for all visitors; `any` hit will do.
    #[inline(never)]
    pub(crate) fn walk_aside(
        &self,
        ray: &Ray,
        t_max: f32,
        any: bool,
        visit: &mut dyn FnMut(usize, usize) -> Leaf,
    ) {
        if any {
            simd::run(Aside { index: self, ray, t_max, visitor: Called::<true>(visit) });
        } else {
            simd::run(Aside { index: self, ray, t_max, visitor: Called::<false>(visit) });
        }
    }

    /// The box around everything.
    pub(crate) fn bounds(&self) -> Bounds3 {
        match self {
            Self::List { bounds, .. } => *bounds,
            Self::Grid(grid) => grid.bounds(),
            Self::Binary(tree) => tree.nodes.first().map_or(Bounds3::EMPTY, |root| root.bounds),
            Self::Wide(bvh) => bvh.bounds(),
            Self::Sixteen(bvh) => bvh.bounds(),
            Self::Compact(bvh) => bvh.bounds(),
        }
    }

    /// Figures about it, without what its owner has packed.
    pub(crate) fn stats(&self) -> Stats {
        match self {
            Self::List { groups, .. } => Stats { leaves: *groups, ..Stats::default() },
            Self::Grid(grid) => {
                let (cells, entries) = grid.cells_and_entries();
                Stats { leaves: cells, references: entries, bytes: grid.bytes(), ..Stats::default() }
            }
            Self::Binary(tree) => Stats { sah_cost: tree.built_sah_cost, ..tree.stats() },
            Self::Wide(bvh) => Stats { bytes: size_of_val(&bvh.nodes[..]), ..bvh.stats },
            Self::Sixteen(bvh) => Stats { bytes: size_of_val(&bvh.nodes[..]), ..bvh.stats },
            Self::Compact(bvh) => Stats { bytes: size_of_val(&bvh.nodes[..]), ..bvh.stats },
        }
    }
}

/// A visitor behind a pointer.
struct Called<'a, const ANY: bool>(&'a mut dyn FnMut(usize, usize) -> Leaf);

impl<const ANY: bool> VisitLeaf for Called<'_, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn visit<S: Simd>(&mut self, first: usize, count: usize) -> Leaf {
        (self.0)(first, count)
    }
}

struct Aside<'a, const ANY: bool> {
    index: &'a Index,
    ray: &'a Ray,
    t_max: f32,
    visitor: Called<'a, ANY>,
}

impl<const ANY: bool> Kernel for Aside<'_, ANY> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(mut self) {
        self.index.walk::<S, _>(self.ray, self.t_max, &mut self.visitor);
    }
}
