//! From the table to the types: one block of [`crate::vocabulary`] becomes a variant of
//! [`Effect`](crate::Effect), a variant of [`EffectName`](crate::EffectName), a struct of
//! parameters and its rows of [`Parameter`](crate::Parameter).
//!
//! ```text
//! /// Force against motion.
//! coulomb: Coulomb, MovingEffort, {           name: type, where it acts
//!     /// Level at sliding.
//!     coulomb: EFFORT, 0.0 => 1.0e6,          parameter: dimension, range of machine files
//! } optional {}                               what it is complete without
//! ```
//!
//! The doc comments are the words for people.

/// Defines the vocabulary from its table.
macro_rules! vocabulary {
    ($(
        $(#[doc = $words:literal])+
        $name:ident: $effect:ident, $place:ident, {
            $($(#[doc = $about:literal])+ $field:ident: $dimension:ident, $min:literal => $max:literal,)*
        } optional {
            $($(#[doc = $about_more:literal])+ $more:ident: $dimension_more:ident, $min_more:literal => $max_more:literal,)*
        }
    )*) => {
        /// The name of an effect.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum EffectName {
            $($(#[doc = $words])+ $effect,)*
        }

        /// An effect with its parameters.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Effect<Q = f64> {
            $($(#[doc = $words])+ $effect($effect<Q>),)*
        }

        $(
            $(#[doc = $words])+
            #[derive(Clone, Copy, Debug, Default, PartialEq)]
            pub struct $effect<Q = f64> {
                $($(#[doc = $about])+ pub $field: Q,)*
                $($(#[doc = $about_more])+ pub $more: Option<Q>,)*
            }

            impl $effect<()> {
                /// Rows of the vocabulary, in the order of the fields.
                const PARAMETERS: &'static [Parameter] = &[
                    $(Parameter {
                        effect: EffectName::$effect,
                        name: stringify!($field),
                        words: concat!($($about),+).trim_ascii(),
                        dimension: Dimension::$dimension,
                        min: $min,
                        max: $max,
                        optional: false,
                    },)*
                    $(Parameter {
                        effect: EffectName::$effect,
                        name: stringify!($more),
                        words: concat!($($about_more),+).trim_ascii(),
                        dimension: Dimension::$dimension_more,
                        min: $min_more,
                        max: $max_more,
                        optional: true,
                    },)*
                ];
            }

            impl<Q> From<$effect<Q>> for Effect<Q> {
                fn from(effect: $effect<Q>) -> Self {
                    Self::$effect(effect)
                }
            }
        )*

        impl EffectName {
            /// Every name, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$effect),*];

            /// The name as it is printed and read.
            #[must_use]
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$effect => stringify!($name),)*
                }
            }

            /// What it is, for people.
            #[must_use]
            pub const fn words(self) -> &'static str {
                match self {
                    $(Self::$effect => concat!($($words),+).trim_ascii(),)*
                }
            }

            /// Where it acts.
            #[must_use]
            pub const fn place(self) -> Place {
                match self {
                    $(Self::$effect => Place::$place,)*
                }
            }

            /// Its parameters.
            #[must_use]
            pub const fn parameters(self) -> &'static [Parameter] {
                match self {
                    $(Self::$effect => $effect::<()>::PARAMETERS,)*
                }
            }
        }

        impl<Q> Effect<Q> {
            /// Its name.
            #[must_use]
            pub const fn name(&self) -> EffectName {
                match self {
                    $(Self::$effect(_) => EffectName::$effect,)*
                }
            }

            /// Its parameters with their rows; optional ones that are not known are left out.
            #[must_use]
            pub fn parts(&self) -> Vec<(&'static Parameter, &Q)> {
                let rows = self.name().parameters().iter();
                match self {
                    $(Self::$effect(own) => {
                        let values: Vec<Option<&Q>> =
                            vec![$(Some(&own.$field),)* $(own.$more.as_ref(),)*];
                        rows.zip(values).filter_map(|(row, value)| Some((row, value?))).collect()
                    })*
                }
            }

            /// The effect of a name from its parameters; `None` where one that is not optional is
            /// missing.
            pub fn assemble(
                name: EffectName,
                mut take: impl FnMut(&'static Parameter) -> Option<Q>,
            ) -> Option<Self> {
                let mut rows = name.parameters().iter();
                let mut next = || rows.next().and_then(&mut take);
                match name {
                    $(EffectName::$effect => Some(Self::$effect($effect {
                        $($field: next()?,)*
                        $($more: next(),)*
                    })),)*
                }
            }
        }
    };
}

pub(crate) use vocabulary;
