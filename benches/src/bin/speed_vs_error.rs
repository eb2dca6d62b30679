//! Speed against error: `speed_vs_error [--trial] FOLDER PART...` writes one CSV a part into FOLDER.
//! `yardstick SCENE` instead prints two times of rapier2d-f64 in µs: of a whole step, and of its step call.

use flockenv_benches::measure::{
    Effort, horizon, momentum, order, overlap, parts, profile, slide, solvers, speed, wall_push,
    work,
};
use flockenv_benches::{Scene, exchange};
use std::path::Path;
use std::time::Instant;

const USAGE: &str = "speed_vs_error [--trial] FOLDER \
    (speed | work | overlap | slide | wall_push | momentum | horizon | order | solvers | profile | parts | \
    tasks FILES | judge FILES)... or speed_vs_error yardstick (jam | cycle)";

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_trial = arguments.iter().any(|argument| argument == "--trial");
    arguments.retain(|argument| argument != "--trial");
    let effort = if is_trial {
        Effort::Trial
    } else {
        Effort::Full
    };
    let mut arguments = arguments.iter().map(String::as_str);
    match arguments.next() {
        Some("yardstick") => {
            let name = arguments.next();
            let scene = Scene::ALL
                .into_iter()
                .find(|scene| Some(scene.name()) == name);
            let [whole, call] = speed::yardstick(scene.expect(USAGE));
            println!("{whole} {call}");
        }
        Some(folder) => {
            while let Some(part) = arguments.next() {
                let start = Instant::now();
                match part {
                    "tasks" => {
                        exchange::write_tasks(Path::new(arguments.next().expect(USAGE)), effort);
                    }
                    "judge" => {
                        let files = Path::new(arguments.next().expect(USAGE));
                        exchange::judge(files, Path::new(folder), effort);
                    }
                    _ => measure(part, Path::new(folder), effort),
                }
                println!("{part}: {:.1} s", start.elapsed().as_secs_f64());
            }
        }
        None => panic!("{USAGE}"),
    }
}

fn measure(part: &str, folder: &Path, effort: Effort) {
    let table = match part {
        "speed" => speed::measure(effort),
        "work" => work::measure(effort),
        "overlap" => overlap::measure(effort),
        "slide" => slide::measure(),
        "wall_push" => wall_push::measure(),
        "momentum" => momentum::measure(),
        "horizon" => horizon::measure(effort),
        "order" => order::measure(effort),
        "solvers" => solvers::measure(effort),
        "profile" => profile::measure(effort),
        "parts" => parts::measure(effort),
        _ => panic!("{USAGE}"),
    };
    table.write(folder, &format!("{part}.csv"));
}
