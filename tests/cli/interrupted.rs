//! Exit code 130.

use super::*;

#[cfg(unix)]
fn interrupt(child: &Child) {
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
}

#[cfg(unix)]
#[test]
fn interrupt_leaves_no_file() {
    let place = Place::new();
    place.put("many.ply", many(300_000));
    place.put("crust.ply", "old");
    let arguments = "many.ply -o crust.ply --mat axis.ma";
    let child = place
        .command(arguments)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(700));
    interrupt(&child);
    let start = Instant::now();
    let ran = Ran::new(arguments, child.wait_with_output().unwrap());
    ran.fails(INTERRUPTED, "interrupted");
    assert!(start.elapsed() < Duration::from_secs(10));
    assert_eq!(place.names(), ["crust.ply", "many.ply"]);
    assert_eq!(place.get("crust.ply"), b"old");
}

#[cfg(unix)]
#[test]
fn interrupt_while_waiting_for_input() {
    let place = Place::new();
    let child = place
        .command("- -o crust.ply")
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(300));
    interrupt(&child);
    // Nothing is sent and the pipe stays open.
    let mut child = child;
    let stdin = child.stdin.take();
    let output = child.wait_with_output().unwrap();
    drop(stdin);
    Ran::new("-", output).fails(INTERRUPTED, "interrupted");
    assert!(place.names().is_empty());
}
