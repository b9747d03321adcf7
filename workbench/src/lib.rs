//! The `quadrant` program as a library, floor by floor. Each floor uses those below it.
//!
//! ```text
//! commands                                   one file each: the list of its steps
//! cli            commissioning               arguments; the steps that are more than a call
//! console, presentation                      results for people
//! circle_test, contour_test, timing_test    tuning    axis_records    tests on a machine
//! session                                    a machine that moves, and stops as one
//! ballbar        trajectory                  what a circle shows; what the axes are to do
//! network                                    master and nodes on any bus
//! drive_parameters, compensation             what the drive is told
//! model_file, output_files                   what is left on disk
//! error, interrupt, progress, stdout         the operator
//! ```
//!
//! Whoever moves axes gets an [`interrupt`] token, so that the operator can stop them.

pub mod axis_records;
pub mod ballbar;
pub mod circle_test;
pub mod cli;
pub mod commands;
pub mod commissioning;
pub mod compensation;
pub mod console;
pub mod contour_test;
pub mod drive_parameters;
pub mod drive_times;
pub mod error;
pub mod interrupt;
pub mod model_file;
pub mod network;
pub mod output_files;
pub mod presentation;
pub mod progress;
pub mod session;
pub mod stdout;
pub mod timing_test;
pub mod trajectory;
pub mod tuning;
