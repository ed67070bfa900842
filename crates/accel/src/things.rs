//! What structures are built over.

use aureole_math::Bounds3;

/// Things by number. Structures see their boxes, and look closer where that helps.
pub(crate) trait Things: Sync {
    /// The box around one.
    fn bounds(&self, id: u32) -> Bounds3;

    /// Whether it is in a box itself, not only its own box.
    fn overlaps(&self, _id: u32, _cell: &Bounds3) -> bool {
        true
    }

    /// Its corners, if it is a triangle that does not move: a builder may cut it.
    fn corners(&self, _id: u32) -> Option<[[f32; 3]; 3]> {
        None
    }
}

/// Boxes and nothing more is known.
pub(crate) struct Boxes<F>(pub F);

impl<F: Fn(u32) -> Bounds3 + Sync> Things for Boxes<F> {
    fn bounds(&self, id: u32) -> Bounds3 {
        self.0(id)
    }
}
