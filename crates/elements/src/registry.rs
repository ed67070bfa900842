//! The macro that turns a family's list of kinds into its enum, builder, manual and static dispatch.

/// Lists a family.
///
/// ```ignore
/// registry! {
///     ($)
///     /// Any built-in filter.
///     Filter: FilterOps, match with each_filter;
///     boxed::BoxFilter as Box = "box",
///     tent::Tent as Tent = "tent",
/// }
/// ```
///
/// The leading `($)` hands the dollar sign to the inner macro. Besides its own kinds every family takes user-defined
/// ones: `Custom(Arc<dyn FilterOps>)`.
macro_rules! registry {
    (
        ($d:tt)
        $(#[$meta:meta])*
        $Family:ident: $Ops:ident, match with $each:ident;
        $($module:ident::$Type:ident as $Variant:ident = $name:literal),* $(,)?
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug)]
        pub enum $Family {
            $(#[doc = concat!("`", $name, "`: see [`", stringify!($Type), "`](", stringify!($module), "::", stringify!($Type), ").")]
              $Variant($module::$Type),)*
            /// An element that a user of the library defined.
            Custom(std::sync::Arc<dyn $Ops>),
        }

        $(impl From<$module::$Type> for $Family {
            fn from(element: $module::$Type) -> Self {
                Self::$Variant(element)
            }
        })*

        /// Runs the same expression on whichever kind a value is, statically dispatched.
        macro_rules! $each {
            ($d value:expr, $d x:ident => $d body:expr) => {
                match $d value {
                    $($Family::$Variant($d x) => $d body,)*
                    $Family::Custom($d x) => $d body,
                }
            };
        }

        impl $Family {
            /// The names of the built-in kinds.
            pub const KINDS: &'static [&'static str] = &[$($name),*];

            /// Builds a built-in kind from its parameters and warns about those it does not know.
            ///
            /// # Errors
            /// [`SceneError::UnknownKind`](aureole_desc::SceneError::UnknownKind), or whatever is wrong with the parameters.
            pub fn build(
                node: &aureole_desc::Node,
                resolver: &mut dyn $crate::Resolver,
            ) -> Result<Self, aureole_desc::SceneError> {
                match node.kind.as_str() {
                    $($name => $crate::element::build::<$module::$Type>(node, resolver).map(Self::from),)*
                    _ => Err(aureole_desc::SceneError::UnknownKind {
                        family: node.family,
                        kind: node.kind.clone(),
                        known: Self::KINDS.iter().map(|kind| kind.to_string()).collect(),
                        at: node.span,
                    }),
                }
            }

            /// The name of a value's kind; `custom` for those that users of the library define.
            pub fn kind(&self) -> &'static str {
                match self {
                    $(Self::$Variant(_) => $name,)*
                    Self::Custom(_) => "custom",
                }
            }

            /// The manual of every built-in kind.
            pub fn manual() -> Vec<$crate::Manual> {
                vec![$($crate::Manual::of::<$module::$Type>($name)),*]
            }
        }
    };
}
