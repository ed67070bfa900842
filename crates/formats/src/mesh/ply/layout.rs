//! Where each property of a row goes.

use aureole_desc::{Attribute, AttributeDomain};

use super::header::{Element, Kind, Property, Scalar};
use crate::mesh::colors;

/// Where a number goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    /// A coordinate of the position.
    Position(usize),
    /// A coordinate of the normal.
    Normal(usize),
    /// A texture coordinate.
    Uv(usize),
    /// A channel of an attribute, over a divisor.
    Attribute { index: usize, channel: usize, divisor: f32 },
    /// The list of a face's vertices.
    Corners,
    /// The list of a face's texture coordinates, two for each corner.
    CornerUvs,
    /// Which of the pictures a face shows.
    Picture,
    /// Nowhere.
    Skip,
}

/// What becomes of an element's rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout {
    /// One target per property.
    pub(super) targets: Vec<Target>,
    /// The attributes, still empty.
    pub(super) attributes: Vec<Attribute>,
    /// Colours whose type is too wide to say how far they go: the attribute, and the type's largest number.
    wide_colors: Vec<(usize, f32)>,
}

/// The usual names of positions, normals and texture coordinates.
fn vertex_target(name: &str) -> Option<Target> {
    Some(match name {
        "x" => Target::Position(0),
        "y" => Target::Position(1),
        "z" => Target::Position(2),
        "nx" => Target::Normal(0),
        "ny" => Target::Normal(1),
        "nz" => Target::Normal(2),
        "u" | "s" | "texture_u" | "texture_s" => Target::Uv(0),
        "v" | "t" | "texture_v" | "texture_t" => Target::Uv(1),
        _ => return None,
    })
}

/// Names of the channels of a colour or vector, in order.
const SERIES: [&[&str]; 5] =
    [&["r", "g", "b"], &["red", "green", "blue"], &["x", "y", "z"], &["0", "1", "2"], &["1", "2", "3"]];

impl Layout {
    pub(super) fn of_vertices(element: &Element) -> Self {
        Self::new(element, "vertex", AttributeDomain::Vertex, |property| match property.kind {
            Kind::One(_) => vertex_target(&property.name),
            Kind::List { .. } => None,
        })
    }

    pub(super) fn of_faces(element: &Element) -> Self {
        Self::new(element, "face", AttributeDomain::Face, |property| {
            match (property.name.as_str(), property.kind) {
                ("vertex_indices" | "vertex_index", Kind::List { .. }) => Some(Target::Corners),
                ("texcoord", Kind::List { .. }) => Some(Target::CornerUvs),
                ("texnumber", Kind::One(_)) => Some(Target::Picture),
                _ => None,
            }
        })
    }

    /// The attributes, once they are filled.
    pub(super) fn into_attributes(mut self) -> Vec<Attribute> {
        for (index, largest) in self.wide_colors {
            let data = &mut self.attributes[index].data;
            let span = colors::span(data.iter().copied(), largest);
            data.iter_mut().for_each(|value| *value /= span);
        }
        self.attributes
    }

    fn new(
        element: &Element,
        prefix: &str,
        domain: AttributeDomain,
        known: impl Fn(&Property) -> Option<Target>,
    ) -> Self {
        let mut layout = Self {
            targets: element.properties.iter().map(|p| known(p).unwrap_or(Target::Skip)).collect(),
            ..Self::default()
        };
        layout.drop_incomplete();
        for i in 0..element.properties.len() {
            if layout.targets[i] == Target::Skip {
                layout.add_attribute(&element.properties, i, prefix, domain);
            }
        }
        layout
    }

    /// A normal or texture coordinate of which a part is missing is none.
    fn drop_incomplete(&mut self) {
        let has = |target| self.targets.contains(&target);
        let normal = (0..3).all(|i| has(Target::Normal(i)));
        let uv = (0..2).all(|i| has(Target::Uv(i)));
        for target in &mut self.targets {
            let drop = match target {
                Target::Normal(_) => !normal,
                Target::Uv(_) => !uv,
                _ => false,
            };
            if drop {
                *target = Target::Skip;
            }
        }
    }

    /// Makes an attribute of the series that starts at property `first`, if one does.
    fn add_attribute(
        &mut self,
        properties: &[Property],
        first: usize,
        prefix: &str,
        domain: AttributeDomain,
    ) {
        let name = properties[first].name.as_str();
        let (stem, start) = name.rsplit_once('_').unwrap_or(("", name));
        let Some(series) = SERIES.iter().find(|series| series[0] == start) else { return };
        let follows = |(property, channel): (&Property, &&str)| {
            let name = property.name.as_str();
            matches!(property.kind, Kind::One(_))
                && name.rsplit_once('_').unwrap_or(("", name)) == (stem, *channel)
        };
        let count = properties[first..].iter().zip(*series).take_while(|&pair| follows(pair)).count();
        // A lone `x` or `1` says nothing, and two channels are no quantity that a texture can show.
        let stem = match (stem, start) {
            ("", "r" | "red") => "color",
            ("", _) => return,
            (stem, _) => stem,
        };
        let channels = if count == 3 { 3 } else { usize::from(count == 1) };
        let index = self.attributes.len();
        for channel in 0..channels {
            let Kind::One(scalar) = properties[first + channel].kind else { continue };
            let is_wide = matches!(scalar, Scalar::I32 | Scalar::U32);
            let divisor = if is_wide { 1.0 } else { scalar.full() };
            self.targets[first + channel] = Target::Attribute { index, channel, divisor };
            if is_wide && channel == 0 && matches!(start, "r" | "red") {
                self.wide_colors.push((index, scalar.full()));
            }
        }
        if channels > 0 {
            let name = format!("{prefix}_{stem}");
            self.attributes.push(Attribute { name, domain, channels, data: Vec::new() });
        }
    }
}
