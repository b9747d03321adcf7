//! A part that the table takes up, or puts down, at a time: mass, friction level and a constant
//! force, m a + f sign(v) + w from then on. It has the table's velocity when it comes.

use axis_model::Payload;

use super::{Instant, Simulated};

/// What a payload brings, once it is there.
fn once_there(own: &Payload, at: &Instant, brings: f64) -> f64 {
    if at.time_s >= own.time { brings } else { 0.0 }
}

impl Simulated for Payload {
    fn added_mass_kg(&self, at: &Instant) -> f64 {
        once_there(self, at, self.payload)
    }

    fn friction_level_n(&self, at: &Instant) -> f64 {
        once_there(self, at, self.friction.unwrap_or(0.0))
    }

    fn table_n(&self, at: &Instant) -> f64 {
        -once_there(self, at, self.weight.unwrap_or(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_payload_brings_mass_friction_and_weight_at_its_time_and_not_before() {
        let part = Payload {
            payload: 80.0,
            time: 4.0,
            friction: Some(12.0),
            weight: Some(785.0),
        };
        let brings = |time_s| {
            let at = Instant {
                time_s,
                ..Instant::default()
            };
            let level_n = part.friction_level_n(&at);
            (part.added_mass_kg(&at), level_n, part.table_n(&at))
        };
        assert_eq!(brings(3.999), (0.0, 0.0, 0.0));
        assert_eq!(brings(4.0), (80.0, 12.0, -785.0));
    }
}
