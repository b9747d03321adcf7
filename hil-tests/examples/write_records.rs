use hil_tests::records::{self, Hidden, Plan};
fn main() {
    let mk = |name: &str, hidden: Vec<Hidden>, load_scale, noise_n, seed| {
        let p = std::path::PathBuf::from("/tmp/mine").join(name);
        std::fs::create_dir_all(&p).unwrap();
        records::write(&p, &Plan { hidden, load_scale, noise_n, seed }).unwrap();
    };
    mk("1027", vec![Hidden::Backlash(12e-6)], true, 1.5, 1027);
    mk("1051", vec![Hidden::Backlash(2e-5), Hidden::TorqueRipple(15.0, 6.0)], true, 1.5, 1051);
    mk("1055", vec![Hidden::Presliding(8e-6), Hidden::Stribeck(1.4, 0.004)], false, 4.0, 1055);
    mk("1041", vec![Hidden::QuadraticDrag(600.0)], false, 9.0, 1041);
}
