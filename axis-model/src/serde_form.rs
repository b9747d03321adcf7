//! The written form: a name as its word, an effect as a table `{ effect = "coulomb", coulomb_n =
//! 400.0 }`.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{self, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::parameter::{ParameterError, Value};
use crate::vocabulary::{Effect, EffectName};

/// The key that holds the name.
const EFFECT: &str = "effect";

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

impl<Q: Value + Serialize> Serialize for Effect<Q> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry(EFFECT, &self.name())?;
        for (parameter, value) in self.parts() {
            map.serialize_entry(&Q::key(parameter), value)?;
        }
        map.end()
    }
}

impl<Q: Value> Effect<Q> {
    /// The effect of a name from what was written, each value in its range.
    ///
    /// # Errors
    /// [`ParameterError`] with the key that is missing, unknown or out of its range.
    pub fn from_entries(
        name: EffectName,
        mut entries: BTreeMap<String, Q>,
    ) -> Result<Self, ParameterError> {
        for parameter in name.parameters() {
            match entries.get(&Q::key(parameter)) {
                Some(value) => value.check(parameter)?,
                None if parameter.optional => {}
                None => return Err(missing(name, &Q::key(parameter), parameter.words)),
            }
        }
        let effect = Self::assemble(name, |parameter| entries.remove(&Q::key(parameter)));
        match (entries.into_keys().next(), effect) {
            (None, Some(effect)) => Ok(effect),
            (key, _) => Err(unknown::<Q>(name, key.unwrap_or_default())),
        }
    }
}

fn missing(name: EffectName, key: &str, words: &str) -> ParameterError {
    ParameterError {
        key: key.into(),
        text: format!("missing in effect \"{name}\": {words}"),
    }
}

fn unknown<Q: Value>(name: EffectName, key: String) -> ParameterError {
    let known: Vec<String> = name.parameters().iter().map(Q::key).collect();
    ParameterError {
        key,
        text: format!(
            "unknown in effect \"{name}\", which has {}; the unit is in the name",
            known.join(", ")
        ),
    }
}

impl<'de, Q: Value + Deserialize<'de>> Deserialize<'de> for Effect<Q> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Table(PhantomData))
    }
}

struct Table<Q>(PhantomData<Q>);

impl<'de, Q: Value + Deserialize<'de>> Visitor<'de> for Table<Q> {
    type Value = Effect<Q>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table with `effect` and its parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Effect<Q>, A::Error> {
        let (mut name, mut entries) = (None, BTreeMap::new());
        while let Some(key) = map.next_key::<String>()? {
            if key == EFFECT {
                name = Some(map.next_value::<EffectName>()?);
            } else {
                entries.insert(key, map.next_value::<Q>()?);
            }
        }
        let name = name.ok_or_else(|| de::Error::missing_field(EFFECT))?;
        Effect::from_entries(name, entries).map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Estimate;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Effect, String> {
        toml::from_str(text).map_err(|error| error.message().to_owned())
    }

    #[test]
    fn an_effect_is_a_table_with_the_unit_of_each_number_in_its_key() {
        let ripple = read("effect = \"torque_ripple\"\namplitude_n = 30.0\norder_per_rev = 4.0");
        let Ok(Effect::TorqueRipple(ripple)) = ripple else {
            panic!("{ripple:?}");
        };
        assert_eq!((ripple.amplitude, ripple.order), (30.0, Some(4.0)));
        assert_eq!((ripple.period, ripple.phase), (None, None));
    }

    #[test]
    fn a_key_that_is_missing_unknown_or_in_another_unit_is_an_error_that_names_it() {
        let error = |text| read(text).unwrap_err();
        assert_eq!(
            error("effect = \"delay\""),
            "delay_s: missing in effect \"delay\": the time"
        );
        assert_eq!(
            error("effect = \"delay\"\ndelay_s = 1e-4\ndelay_ms = 0.1"),
            "delay_ms: unknown in effect \"delay\", which has delay_s; the unit is in the name"
        );
        assert_eq!(
            error("effect = \"delay\"\ndelay_s = 0.1"),
            "delay_s: must be 0 to 0.001 in the unit of its name, got 0.1"
        );
        assert!(error("effect = \"delayed\"").starts_with("unknown effect \"delayed\"; known:"));
        assert!(error("delay_s = 0.0").contains("missing field `effect`"));
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
    fn effect(place: usize, shares: &[f64]) -> Effect {
        let name = EffectName::ALL[place % EffectName::ALL.len()];
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
            place in 0..EffectName::ALL.len(),
            shares in prop::collection::vec(0.0..1.0, 5),
        ) {
            let written = effect(place, &shares);
            let text = toml::to_string(&written).unwrap();
            prop_assert_eq!(read(&text), Ok(written));
        }

        #[test]
        fn an_estimate_is_read_back_with_its_interval_and_unit(
            place in 0..EffectName::ALL.len(),
            shares in prop::collection::vec(0.0..1.0, 5),
        ) {
            let written = effect(place, &shares);
            let estimated = Effect::assemble(written.name(), |parameter| {
                let (_, value) = written.parts().into_iter().find(|(row, _)| *row == parameter)?;
                let (low, high) = (value - 1.0, value + 1.0);
                Some(Estimate { value: *value, unit: "N m".into(), low, high })
            })
            .unwrap();
            let text = toml::to_string(&estimated).unwrap();
            prop_assert_eq!(toml::from_str::<Effect<Estimate>>(&text).unwrap(), estimated);
        }
    }
}
