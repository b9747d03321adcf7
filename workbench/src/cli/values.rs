//! Values of the command line that are more than a word or a number.

use bus::FaultPlan;

use crate::error::{Failure, Outcome};
use crate::trajectory::Circle;

/// A node id in decimal or hexadecimal.
pub(super) fn node_id(text: &str) -> Result<u8, String> {
    let number = text
        .strip_prefix("0x")
        .map_or_else(|| text.parse(), |hex| u8::from_str_radix(hex, 16));
    match number.ok().and_then(protocol::NodeId::new) {
        Some(id) => Ok(id.get()),
        None => Err(format!(
            "a CANopen node id is 1 to 127 (0x01 to 0x7F), got {text}"
        )),
    }
}

/// A circle from the units of the command line.
///
/// # Errors
/// Where a value is not positive.
pub fn circle(radius_mm: f64, feed_mm_min: f64) -> Outcome<Circle> {
    let radius_mm = above_zero("--radius-mm", radius_mm, "mm")?;
    Ok(Circle {
        radius_m: 1.0e-3 * radius_mm,
        feed_m_per_s: feed(feed_mm_min)?,
        turns: 3,
        counter_clockwise: true,
    })
}

/// A feed in m/s.
///
/// # Errors
/// Where it is not positive.
pub fn feed(feed_mm_min: f64) -> Outcome<f64> {
    Ok(above_zero("--feed-mm-min", feed_mm_min, "mm/min")? / 6.0e4)
}

/// A length in µm, above zero.
pub(super) fn micrometres(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok();
    let value = value.filter(|um| um.is_finite() && *um > 0.0);
    value.ok_or_else(|| format!("must be above zero µm, got {text}"))
}

fn above_zero(option: &str, value: f64, unit: &str) -> Outcome<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Failure::new(format!(
            "{option}: must be above zero {unit}, got {value}"
        )))
    }
}

/// Faults begin here unless the plan says otherwise: when the axes are enabled.
const FAULTS_FROM_CYCLE: u32 = 100;

/// A plan of faults: seed,lost,doubled,late,corrupted[,from cycle].
pub(super) fn fault_plan(text: &str) -> Result<FaultPlan, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
    let (seed, shares, from_cycle) = match numbers.unwrap_or_default()[..] {
        [seed, a, b, c, d] => (seed, [a, b, c, d], FAULTS_FROM_CYCLE),
        [seed, a, b, c, d, from_cycle] => (seed, [a, b, c, d], from_cycle),
        _ => {
            return Err(format!(
                "five or six whole numbers, seed,lost,doubled,late,corrupted[,from cycle], got {text}"
            ));
        }
    };
    let [
        lost_per_mille,
        doubled_per_mille,
        late_per_mille,
        corrupted_per_mille,
    ] = per_mille(shares)?;
    Ok(FaultPlan {
        seed: u64::from(seed),
        lost_per_mille,
        doubled_per_mille,
        late_per_mille,
        corrupted_per_mille,
        from_cycle,
        ..FaultPlan::default()
    })
}

/// Shares of all frames: no more than all of them.
fn per_mille(shares: [u32; 4]) -> Result<[u16; 4], String> {
    if shares.iter().sum::<u32>() > 1000 {
        return Err(format!(
            "the shares are per mille of all frames and make at most 1000 together, got {shares:?}"
        ));
    }
    Ok(shares.map(|share| u16::try_from(share).unwrap_or(u16::MAX)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_plan_has_four_shares_and_perhaps_a_first_cycle() {
        let plan = fault_plan("7,50,0,10,0").unwrap();
        assert_eq!(
            (
                plan.seed,
                plan.lost_per_mille,
                plan.late_per_mille,
                plan.from_cycle
            ),
            (7, 50, 10, 100)
        );
        assert_eq!(fault_plan("7,50,0,10,0,2000").unwrap().from_cycle, 2000);
    }

    #[test]
    fn a_fault_plan_that_is_none_is_refused_with_what_was_wanted() {
        for wrong in [
            "",
            "7",
            "7,50,0,10",
            "7,50,0,10,0,1,1",
            "7,50,0,-10,0",
            "a,b,c,d,e",
        ] {
            assert!(
                fault_plan(wrong)
                    .unwrap_err()
                    .contains("five or six whole numbers"),
                "{wrong}"
            );
        }
        assert!(
            fault_plan("7,500,500,1,0")
                .unwrap_err()
                .contains("at most 1000")
        );
    }

    #[test]
    fn a_node_id_is_read_in_decimal_and_in_hexadecimal() {
        assert_eq!((node_id("17"), node_id("0x11")), (Ok(17), Ok(17)));
        for wrong in ["0", "128", "0x80", "-1", "x"] {
            assert!(node_id(wrong).unwrap_err().ends_with(wrong), "{wrong}");
        }
    }

    #[test]
    fn a_circle_is_told_in_workshop_units_and_kept_in_si() {
        let circle = circle(100.0, 2000.0).unwrap();
        assert!((circle.radius_m - 0.1).abs() < 1.0e-12);
        assert!((circle.feed_m_per_s - 2.0 / 60.0).abs() < 1.0e-12);
    }

    #[test]
    fn a_circle_without_size_or_feed_is_refused_by_its_option() {
        for (radius_mm, feed_mm_min, option) in [
            (0.0, 2000.0, "--radius-mm"),
            (f64::NAN, 2000.0, "--radius-mm"),
            (100.0, -1.0, "--feed-mm-min"),
            (100.0, f64::INFINITY, "--feed-mm-min"),
        ] {
            let refusal = circle(radius_mm, feed_mm_min).unwrap_err().to_string();
            assert!(refusal.starts_with(option), "{refusal}");
        }
    }
}
