//! A scene's objects as its XML files give them, before translation.

use aureole_desc::{Params, Span};
use rustc_hash::FxHashMap;

/// What kind of thing an XML element makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tag {
    Scene,
    Integrator,
    Sensor,
    Film,
    Filter,
    Sampler,
    Shape,
    Bsdf,
    Emitter,
    Texture,
    Spectrum,
    Medium,
    Phase,
    Volume,
}

impl Tag {
    /// The words in files. Mitsuba 0.4 called some of them otherwise.
    const WORDS: [(&str, Self); 17] = [
        ("scene", Self::Scene),
        ("integrator", Self::Integrator),
        ("sensor", Self::Sensor),
        ("camera", Self::Sensor),
        ("film", Self::Film),
        ("rfilter", Self::Filter),
        ("sampler", Self::Sampler),
        ("shape", Self::Shape),
        ("bsdf", Self::Bsdf),
        ("emitter", Self::Emitter),
        ("luminaire", Self::Emitter),
        ("texture", Self::Texture),
        ("spectrum", Self::Spectrum),
        ("medium", Self::Medium),
        ("phase", Self::Phase),
        ("volume", Self::Volume),
        ("subsurface", Self::Medium),
    ];

    pub(super) fn parse(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, tag)| *tag)
    }

    pub(super) fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, tag)| *tag == self).map_or("object", |(word, _)| word)
    }
}

/// Names an object of a [`Tree`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ObjectId(usize);

impl ObjectId {
    pub(super) fn index(self) -> usize {
        self.0
    }
}

/// An instance of a plugin.
#[derive(Clone, Debug)]
pub(super) struct Object {
    pub(super) tag: Tag,
    /// The plugin's name, e.g. `roughconductor`.
    pub(super) plugin: String,
    /// The id by which others refer to it.
    pub(super) id: Option<String>,
    /// Plain properties.
    pub(super) values: Params,
    /// Nested objects and references.
    pub(super) children: Vec<Child>,
    /// The start tag.
    pub(super) span: Span,
}

/// An object inside another.
#[derive(Clone, Debug)]
pub(super) struct Child {
    /// The property's name, if it has one.
    pub(super) name: Option<String>,
    pub(super) target: Target,
    pub(super) span: Span,
}

/// What a child is.
#[derive(Clone, Debug)]
pub(super) enum Target {
    /// A nested object.
    Object(ObjectId),
    /// The id of an object elsewhere, possibly later.
    Reference(String),
}

/// All objects of a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    objects: Vec<Object>,
    ids: FxHashMap<String, ObjectId>,
    aliases: FxHashMap<String, String>,
}

impl Tree {
    pub(super) fn add(&mut self, object: Object) -> ObjectId {
        self.objects.push(object);
        ObjectId(self.objects.len() - 1)
    }

    pub(super) fn len(&self) -> usize {
        self.objects.len()
    }

    /// All objects, in the order of their files.
    pub(super) fn objects(&self) -> impl Iterator<Item = &Object> {
        self.objects.iter()
    }

    pub(super) fn get(&self, id: ObjectId) -> &Object {
        &self.objects[id.0]
    }

    pub(super) fn get_mut(&mut self, id: ObjectId) -> &mut Object {
        &mut self.objects[id.0]
    }

    /// Whether there is any object of a family.
    pub(super) fn has(&self, tag: Tag) -> bool {
        self.objects.iter().any(|object| object.tag == tag)
    }

    /// Gives an object its id; gives the object back that has it already.
    pub(super) fn register(&mut self, id: &str, object: ObjectId) -> Option<ObjectId> {
        let old = self.ids.get(id).copied();
        if old.is_none() {
            self.ids.insert(id.to_owned(), object);
        }
        old
    }

    /// Makes `alias` another word for `id`.
    pub(super) fn add_alias(&mut self, id: String, alias: String) {
        self.aliases.insert(alias, id);
    }

    /// The object that an id or alias names.
    pub(super) fn find(&self, id: &str) -> Option<ObjectId> {
        // Aliases of aliases of aliases are no scene's need, and might go round in circles.
        const MOST: usize = 64;
        let mut id = id;
        for _ in 0..MOST {
            if let Some(&object) = self.ids.get(id) {
                return Some(object);
            }
            id = self.aliases.get(id)?;
        }
        None
    }

    /// All ids, in no order, for messages.
    pub(super) fn known_ids(&self) -> impl Iterator<Item = &str> + Clone {
        self.ids.keys().chain(self.aliases.keys()).map(String::as_str)
    }
}
