//! The written form: a name as its word, effects as a table with one entry for each name.
//!
//! ```toml
//! offset_n = 25.0                                          # a single number: name and unit
//! stribeck = { excess_n = 120.0, velocity_m_per_s = 1.5e-3 }
//! torque_ripple = [                                        # more than one of a name: a list
//!   { amplitude_n = 40.0, order_per_rev = 6.0 },
//!   { amplitude_n = 12.0, order_per_rev = 12.0, phase_rad = 0.3 },
//! ]
//! ```
//!
//! Every value is checked against its range while it is read, so that an error knows its line.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::vocabulary::{Effect, EffectName, Parameter, ParameterError};

impl Serialize for EffectName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for EffectName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        word.parse().map_err(de::Error::custom)
    }
}

impl EffectName {
    /// The first parameter, which alone may stand for the effect.
    fn first(self) -> &'static Parameter {
        &self.parameters()[0]
    }

    /// Key under which the first parameter alone is written: `offset_n`.
    fn short_key(self) -> String {
        format!("{self}{}", self.first().dimension.key_end())
    }

    /// Whether all but the first parameter may be left out.
    fn is_short(self) -> bool {
        self.parameters()[1..].iter().all(|row| row.optional)
    }
}

impl Effect {
    /// The effect of a name from the keys that were written, each value in its range.
    ///
    /// # Errors
    /// [`ParameterError`] with the key that is missing, unknown or out of its range.
    pub fn from_entries(
        name: EffectName,
        mut entries: BTreeMap<String, f64>,
    ) -> Result<Self, ParameterError> {
        for parameter in name.parameters() {
            match entries.get(&parameter.key()) {
                Some(value) => parameter.check(*value)?,
                None if parameter.optional => {}
                None => return Err(missing(parameter)),
            }
        }
        let effect = Self::assemble(name, |parameter| entries.remove(&parameter.key()));
        match (entries.into_keys().next(), effect) {
            (None, Some(effect)) => Ok(effect),
            (key, _) => Err(unknown(name, key.unwrap_or_default())),
        }
    }

    fn entries(&self) -> BTreeMap<String, f64> {
        let parts = self.parts().into_iter();
        parts.map(|(row, value)| (row.key(), *value)).collect()
    }
}

fn missing(parameter: &Parameter) -> ParameterError {
    ParameterError {
        key: parameter.key(),
        text: format!("missing in `{}`: {}", parameter.effect, parameter.words),
    }
}

fn unknown(name: EffectName, key: String) -> ParameterError {
    let known: Vec<String> = name.parameters().iter().map(Parameter::key).collect();
    ParameterError {
        key,
        text: format!(
            "unknown in `{name}`, which has {}; the unit is in the name",
            known.join(", ")
        ),
    }
}

/// Effects as a table; read in the order of the vocabulary.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectTable(pub Vec<Effect>);

impl Serialize for EffectTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for name in EffectName::ALL {
            let own = self.0.iter().filter(|effect| effect.name() == *name);
            let written: Vec<BTreeMap<String, f64>> = own.map(Effect::entries).collect();
            match written.as_slice() {
                [] => {}
                [one] => match one.get(&name.first().key()) {
                    Some(alone) if one.len() == 1 => {
                        map.serialize_entry(&name.short_key(), alone)?;
                    }
                    _ => map.serialize_entry(name, one)?,
                },
                several => map.serialize_entry(name, several)?,
            }
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for EffectTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Table)
    }
}

struct Table;

impl<'de> Visitor<'de> for Table {
    type Value = EffectTable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of effects")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<EffectTable, A::Error> {
        let mut effects = Vec::new();
        while let Some(key) = map.next_key::<Key>()? {
            effects.extend(map.next_value_seed(key)?);
        }
        effects.sort_by_key(Effect::name);
        Ok(EffectTable(effects))
    }
}

/// A key of the table, which reads what is behind it.
#[derive(Clone, Copy)]
struct Key {
    name: EffectName,
    /// `offset_n = 25.0` and not `torque_ripple = { … }`; a ratio, which has no unit, may be both.
    short: bool,
}

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        let is_short = |name: &EffectName| name.is_short() && name.short_key() == word;
        if let Some(name) = EffectName::ALL.iter().copied().find(is_short) {
            return Ok(Self { name, short: true });
        }
        let name = word.parse().map_err(|_| {
            let known = known_keys().join(", ");
            let text = format!("unknown effect `{word}`; known: {known}; the unit is in the name");
            de::Error::custom(text)
        })?;
        Ok(Self { name, short: false })
    }
}

/// The shortest way to write each effect.
fn known_keys() -> Vec<String> {
    let key = |name: &EffectName| {
        if name.is_short() {
            name.short_key()
        } else {
            format!("{name} = {{ … }}")
        }
    };
    EffectName::ALL.iter().map(key).collect()
}

impl<'de> DeserializeSeed<'de> for Key {
    type Value = Vec<Effect>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<Effect>, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Key {
    type Value = Vec<Effect>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.short {
            write!(f, "a number for {}", self.name.short_key())
        } else {
            write!(f, "the parameters of {}, or a list of them", self.name)
        }
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Vec<Effect>, E> {
        if !self.short {
            return Err(E::invalid_type(de::Unexpected::Float(value), &self));
        }
        let key = self.name.short_key();
        let first = self.name.first();
        let checked = first.check(value);
        checked.map_err(|error| E::custom(ParameterError { key, ..error }))?;
        let entries = BTreeMap::from([(first.key(), value)]);
        let effect = Effect::from_entries(self.name, entries).map_err(E::custom)?;
        Ok(vec![effect])
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Vec<Effect>, E> {
        self.visit_f64(value as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<Effect>, A::Error> {
        let entries = BTreeMap::deserialize(de::value::MapAccessDeserializer::new(map))?;
        let effect = Effect::from_entries(self.name, entries).map_err(|error| {
            let key = format!("{}.{}", self.name, error.key);
            de::Error::custom(ParameterError { key, ..error })
        })?;
        Ok(vec![effect])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<Effect>, A::Error> {
        let mut effects = Vec::new();
        while let Some(more) = list.next_element_seed(self)? {
            effects.extend(more);
        }
        Ok(effects)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Offset, TorqueRipple};
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Vec<Effect>, String> {
        let table: Result<EffectTable, _> = toml::from_str(text);
        table
            .map(|table| table.0)
            .map_err(|error| error.message().to_owned())
    }

    #[test]
    fn the_unit_of_each_number_is_in_its_key() {
        let ripple = |amplitude, order| {
            Effect::from(TorqueRipple {
                amplitude,
                order: Some(order),
                ..TorqueRipple::default()
            })
        };
        let one = "torque_ripple = { amplitude_n = 30.0, order_per_rev = 4 }\n";
        assert_eq!(read(one), Ok(vec![ripple(30.0, 4.0)]));
        let two = "torque_ripple = [{ amplitude_n = 30.0, order_per_rev = 4.0 },\
                   { amplitude_n = 9.0, order_per_rev = 8.0 }]\noffset_n = 25";
        let offset = Effect::from(Offset { offset: 25.0 });
        let all = vec![offset, ripple(30.0, 4.0), ripple(9.0, 8.0)];
        assert_eq!(read(two), Ok(all));
        assert_eq!(read("offset = { offset_n = 25.0 }"), Ok(vec![offset]));
    }

    #[test]
    fn a_ratio_is_written_as_a_number_or_as_a_table() {
        let number = read("coulomb_asymmetry = 0.1");
        assert_eq!(
            number,
            read("coulomb_asymmetry = { coulomb_asymmetry = 0.1 }")
        );
        assert_eq!(number.unwrap()[0].name(), EffectName::CoulombAsymmetry);
    }

    #[test]
    fn a_key_that_is_missing_unknown_or_in_another_unit_is_an_error_that_names_it() {
        let error = |text| read(text).unwrap_err();
        assert_eq!(
            error("stribeck = { excess_n = 3.0 }"),
            "stribeck.velocity_m_per_s: missing in `stribeck`: velocity at which 1/e of the excess \
             is left"
        );
        assert_eq!(
            error("delay = { delay_s = 1e-4, delay_ms = 0.1 }"),
            "delay.delay_ms: unknown in `delay`, which has delay_s; the unit is in the name"
        );
        assert_eq!(
            error("delay_s = 0.1"),
            "delay_s: must be 0 to 0.001 in the unit of its name, got 0.1"
        );
        assert_eq!(
            error("pitch_error = { amplitude_m = 1.0, period_m = 1.0 }"),
            "pitch_error.amplitude_m: must be 0 to 0.001 in the unit of its name, got 1"
        );
        let wrong_unit = error("delay_ms = 0.1");
        assert!(wrong_unit.starts_with("unknown effect `delay_ms`; known: inertia_n_s2_per_m,"));
        assert!(
            wrong_unit.contains("stribeck = { … }")
                && wrong_unit.contains("delay_s, logged_late_s;")
        );
        assert!(error("offset_n = \"25 N\"").contains("a number for offset_n"));
        assert!(error("stribeck = 3.0").contains("the parameters of stribeck"));
    }

    #[test]
    fn each_range_takes_its_ends_and_nothing_beyond_them() {
        for parameter in EffectName::ALL.iter().flat_map(|name| name.parameters()) {
            let beyond = 1.0e-6 * (parameter.max - parameter.min);
            for (value, fits) in [
                (parameter.min, true),
                (parameter.max, true),
                (parameter.min - beyond, false),
                (parameter.max + beyond, false),
                (f64::NAN, false),
            ] {
                let checked = parameter.check(value);
                assert_eq!(checked.is_ok(), fits, "{} = {value}", parameter.key());
            }
        }
    }

    /// An effect from the seeds of its values: a share of each range; every second optional
    /// parameter is left out.
    fn effect(name: EffectName, shares: &[f64]) -> Effect {
        let mut shares = shares.iter().copied().cycle();
        Effect::assemble(name, |parameter| {
            let share = shares.next()?;
            let value = parameter.min + share * (parameter.max - parameter.min);
            (!parameter.optional || share < 0.5).then_some(value)
        })
        .expect("all that is needed is there")
    }

    proptest! {
        #[test]
        fn what_is_written_is_read_back(
            shares in prop::collection::vec(0.0..1.0, 7),
            count in 1..3_usize,
        ) {
            let all = EffectName::ALL.iter();
            let written: Vec<Effect> =
                all.flat_map(|name| vec![effect(*name, &shares); count]).collect();
            let text = toml::to_string(&EffectTable(written.clone())).unwrap();
            prop_assert_eq!(read(&text), Ok(written));
        }
    }
}
