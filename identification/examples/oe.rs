use identification::actuator::Pair;
use identification::bench::Bench;
use identification::free_run::{Drive, judge};
use identification::kinematics::Kinematics;
use identification::{Dataset, selection, actuator};
fn main() {
    for folder in std::env::args().skip(1) {
        let mut dataset = Dataset::read(std::path::Path::new(&folder), None, None).unwrap();
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let low = Kinematics::with_cutoff(&dataset, &dataset.train, actuator::delay_cutoff_hz(dataset.train.period_s)).unwrap();
        if std::env::var_os("FOLLOW").is_some() { dataset.controller = None; }
        let (bench, low) = (Bench::new(&dataset, &motion), Bench::new(&dataset, &low));
        let pair = Pair { bench: &bench, low: &low };
        let mut declared = selection::declared_model(&dataset);
        selection::prepare(pair, &mut declared);
        let sel = selection::select(pair, declared.clone(), &mut |_| ());
        let co = bench.fit(&sel.model).coefficients;
        let t1 = std::time::Instant::now();
        let r = judge::reversals(&dataset, &sel.model, &co).unwrap();
        let known = match &r.drive { Drive::Known(l) => format!("law {:.4}", l.misfit), Drive::Followed => "followed".into() };
        let sh = |j: &judge::Judged| format!("{:.3}/{:.3}", j.held_out*1e6, j.all*1e6);
        let o = |j: &Option<judge::Judged>| j.as_ref().map_or("-".into(), |j| format!("{} g{:.2} d{:.2}", sh(j), j.model.shape.gap*1e6, j.model.shape.deflection*1e6));
        println!("{} {:?} {known} rigid {} bristle {} d{:.2} gap {} both {} -> {:?} {:.1?}", dataset.name, sel.found, sh(&r.rigid), sh(&r.bristle), r.bristle.model.shape.deflection*1e6, o(&r.gap), o(&r.both), (r.accepted.presliding, r.accepted.backlash, r.accepted.undecided), t1.elapsed());
    }
}
