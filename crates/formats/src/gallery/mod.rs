//! Scenes that come with the library: small, self-contained, each a text to start from.

use aureole_desc::{Report, SceneDesc, SceneError, Sources};

use crate::{LoadOptions, load_text};

/// An embedded scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GalleryScene {
    /// Its name.
    pub name: &'static str,
    /// What it shows, in one sentence.
    pub summary: &'static str,
    /// The name of its format.
    pub format: &'static str,
    /// The suffix of its format.
    pub suffix: &'static str,
    /// The scene file.
    pub text: &'static str,
}

/// All embedded scenes; the first is rendered when no scene is named.
pub const GALLERY: &[GalleryScene] = &[
    GalleryScene {
        name: "cornell-box",
        summary: "the box of Cornell University, as it was measured: soft shadows, colours that bleed",
        format: "pbrt",
        suffix: "pbrt",
        text: include_str!("cornell-box.pbrt"),
    },
    GalleryScene {
        name: "materials",
        summary: "nine balls: paint, plastic, metals, glass, mirrors, smooth and rough",
        format: "mitsuba",
        suffix: "xml",
        text: include_str!("materials.xml"),
    },
    GalleryScene {
        name: "open-pbr",
        summary: "nine balls of one material, the OpenPBR surface: velvet, clay, car paint, glass, gold",
        format: "mitsuba",
        suffix: "xml",
        text: include_str!("open-pbr.xml"),
    },
    GalleryScene {
        name: "glass",
        summary: "clear, frosted and hollow glass that gathers light on a table",
        format: "mitsuba",
        suffix: "xml",
        text: include_str!("glass.xml"),
    },
    GalleryScene {
        name: "instances",
        summary: "one column of four shapes, placed sixteen times on a checkered floor",
        format: "mitsuba",
        suffix: "xml",
        text: include_str!("instances.xml"),
    },
];

impl GalleryScene {
    /// The embedded scene of that name.
    ///
    /// # Errors
    /// [`SceneError::UnknownName`].
    pub fn find(name: &str) -> Result<&'static Self, SceneError> {
        GALLERY.iter().find(|scene| scene.name == name).ok_or_else(|| SceneError::UnknownName {
            what: "gallery scene",
            name: name.to_owned(),
            known: GALLERY.iter().map(|scene| scene.name.to_owned()).collect(),
            at: aureole_desc::Span::NONE,
        })
    }

    /// The name that the scene's file would have.
    pub fn file_name(&self) -> String {
        format!("{}.{}", self.name, self.suffix)
    }

    /// Reads the scene.
    ///
    /// # Errors
    /// As [`load_text`]; without definitions there are none (tested).
    pub fn load(
        &self,
        options: &LoadOptions,
        sources: &mut Sources,
        report: &mut Report,
    ) -> Result<SceneDesc, SceneError> {
        load_text(self.format, &self.file_name(), self.text, options, sources, report)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_read_without_a_warning() {
        for scene in GALLERY {
            let (mut sources, mut report) = (Sources::default(), Report::default());
            let read = scene.load(&LoadOptions::default(), &mut sources, &mut report);
            let desc = read.unwrap_or_else(|error| panic!("{}: {error}", scene.name));
            assert_eq!(report.warnings, [], "{}", scene.name);
            assert!(!desc.shapes.is_empty() && desc.cameras.len() == 1, "{}", scene.name);
        }
    }

    #[test]
    fn a_misspelt_name_is_corrected() {
        let error = GalleryScene::find("cornel-box").unwrap_err();
        assert!(error.help().unwrap().contains("`cornell-box`"));
    }
}
