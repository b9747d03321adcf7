//! scratch
use workbench::{ballbar, run::{Place, Session}, trajectory::{Circle, MEASURE_FROM_RAD}, compensation::*};
fn main() {
    let mut machine = plant_sim::Machine::reference();
    for a in &mut machine.axes { a.actual.force_noise_n = 0.0; }
    let none = AxisCompensation::default();
    let pulse = AxisCompensation { reversal: Compensation::Pulse(Pulse { height_m_per_s: 1.761e-3, time_constant_s: 0.0867, start_delay_s: 0.0 }), backlash_m: 0.0 };
    let coulomb = AxisCompensation { reversal: Compensation::Coulomb { force_n: 400.0 }, backlash_m: 0.0 };
    for (name, c) in [("none", none), ("pulse", pulse), ("coulomb", coulomb)] {
        for (r, f) in [(100.0, 500.0), (100.0, 2000.0), (25.0, 1000.0), (100.0, 8000.0), (10.0, 1000.0)] {
            let t = std::time::Instant::now();
            let circle = Circle { radius_m: r * 1e-3, feed_m_per_s: f / 6e4, turns: 3, counter_clockwise: true };
            let mut s = Session::open(&machine, &Place::InProcess, &[c, c], 0).unwrap();
            let p = s.circle(&circle).unwrap();
            let fig = ballbar::figures(&p, circle.radius_m, 0.0, MEASURE_FROM_RAD);
            println!("{name} {r} {f} {:.2} {:?} G {:.1} ell {:.2} step {:?} x{:.0}", fig.peak_max_um, fig.peak_um, fig.circular_deviation_g_um, fig.ellipse_um, fig.step_um, 2.0*s.cycles() as f64*1e-3/t.elapsed().as_secs_f64());
        }
    }
}
