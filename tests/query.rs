//! Questions to a medial axis.

mod common;

use common::random::Random;
use common::shapes::{Shape, TORUS};
use common::threads;
use powercrust::axis::{Answer, LabelledBalls, MedialAxis, NO_BALL};
use powercrust::{
    reconstruct, Ball, Bounds, Context, Error, Options, Point, PowerShape, Reconstruction, Side,
};

fn torus() -> (Vec<Point>, Reconstruction) {
    let points = TORUS.spaced_samples(1500, 0.12, 5);
    let result = reconstruct(&points, &Options::default(), &Context::default()).unwrap();
    (points, result)
}

fn ask(axis: &MedialAxis, points: &[Point]) -> Vec<Answer> {
    axis.ask(points, &Context::default()).unwrap()
}

fn random_points(of: &[Point], count: usize, scale: f64) -> Vec<Point> {
    let bounds = Bounds::of(of).unwrap();
    let mut random = Random::new(3);
    let at = |random: &mut Random| {
        [0, 1, 2].map(|k| scale * random.within(bounds.min[k], bounds.max[k]))
    };
    (0..count).map(|_| at(&mut random)).collect()
}

#[test]
fn answers_are_those_of_a_search_through_all_balls() {
    let (points, result) = torus();
    let axis = result.medial_axis();
    let asked = [random_points(&points, 300, 1.2), points[..100].to_vec()].concat();
    let found = ask(&axis, &asked);
    for (p, answer) in asked.iter().zip(&found) {
        let least = |side: Option<Side>| {
            let own = result
                .balls
                .iter()
                .filter(|b| side.is_none_or(|s| b.side == s));
            own.map(|b| b.ball.power(*p)).fold(f64::INFINITY, f64::min)
        };
        let power = |b: u32| result.balls[b as usize].ball.power(*p);
        // The centres were rounded in the balls' coordinates.
        let same = |a: f64, b: f64| (a - b).abs() < 1e-6;
        assert!(same(power(answer.ball), least(None)));
        assert!(same(power(answer.inner), least(Some(Side::Inner))));
        assert_eq!(result.balls[answer.ball as usize].side, answer.side);
        let radius = result.balls[answer.inner as usize].ball.radius;
        assert!((answer.thickness - 2.0 * radius).abs() < 1e-9);
        let [low, high] = answer.bounds;
        assert!(low <= answer.distance && answer.distance <= high);
    }
    // Each question alone, and whatever the threads.
    for n in [1, 4] {
        let cx = threads(n);
        assert_eq!(axis.ask(&asked, &cx).unwrap(), found);
    }
    let cx = Context::default();
    let all = |of: &dyn Fn(&Answer) -> f64| found.iter().map(of).collect::<Vec<f64>>();
    assert_eq!(axis.thickness(&asked, &cx).unwrap(), all(&|a| a.thickness));
    assert_eq!(
        axis.signed_distance(&asked, &cx).unwrap(),
        all(&|a| a.distance)
    );
    let sides: Vec<Side> = found.iter().map(|a| a.side).collect();
    assert_eq!(axis.side(&asked, &cx).unwrap(), sides);
    let balls: Vec<u32> = found.iter().map(|a| a.ball).collect();
    assert_eq!(axis.nearest_ball(&asked, &cx).unwrap(), balls);
    // The same axis by its balls.
    let again = MedialAxis::of(&LabelledBalls::of(result, &points));
    assert_eq!(ask(&again, &asked), found);
}

#[test]
fn sides_and_distances_are_those_of_the_torus() {
    let (points, result) = torus();
    let axis = result.medial_axis();
    for scale in [1.0, 2.0, 50.0] {
        let asked = random_points(&points, 2000, scale);
        for (p, answer) in asked.iter().zip(ask(&axis, &asked)) {
            let truth = TORUS.signed_distance(*p);
            let inside = answer.side == Side::Inner;
            assert!(
                truth.abs() < 0.02 || inside == (truth < 0.0),
                "{truth} {answer:?}"
            );
            assert!((answer.distance - truth).abs() < 0.04, "{truth} {answer:?}");
        }
    }
    // On the axis of the tube it is as thick as the tube.
    let [middle] = ask(&axis, &[[1.0, 0.0, 0.0]])[..] else {
        panic!("one answer")
    };
    assert!((middle.thickness - 0.8).abs() < 0.02, "{middle:?}");
    // Beyond everything.
    let far = ask(&axis, &[[1e300, 0.0, 0.0], [0.0, -1e18, 0.0]]);
    assert!(far.iter().all(|a| a.side == Side::Outer));
}

#[test]
fn ties_belong_to_the_solid() {
    let ball = |x: f64| Ball::new([x, 0.0, 0.0], 1.0);
    let shape = PowerShape {
        balls: vec![ball(-2.0), ball(-4.0)],
        others: vec![ball(2.0), ball(4.0)],
        ..PowerShape::default()
    };
    let balls = LabelledBalls::of_shape(&shape, &Context::default()).unwrap();
    let axis = MedialAxis::of(&balls);
    // As far from both, exactly, and a step of the lattice beside.
    let step = 2f64.powi(-40);
    let asked = [
        [0.0, 0.3, 0.0],
        [step, 0.3, 0.0],
        [-step, 0.3, 0.0],
        [-3.0, 0.0, 0.0],
    ];
    let found = ask(&axis, &asked);
    let sides: Vec<Side> = found.iter().map(|a| a.side).collect();
    assert_eq!(sides, [Side::Inner, Side::Outer, Side::Inner, Side::Inner]);
    // Nothing is near the corner of the frame.
    let corner = ask(&axis, &[[-20.0, -20.0, -20.0]])[0];
    assert!(corner.side == Side::Outer || corner.ball != NO_BALL);
}

#[test]
fn inner_balls_alone_are_asked_for_their_union() {
    let shape = PowerShape {
        balls: vec![Ball::new([0.0; 3], 1.0), Ball::new([3.0, 0.0, 0.0], 1.0)],
        ..PowerShape::default()
    };
    let balls = LabelledBalls::of_shape(&shape, &Context::default()).unwrap();
    let axis = MedialAxis::of(&balls);
    assert!(!axis.has_both_sides());
    let found = ask(
        &axis,
        &[
            [0.0, 0.5, 0.0],
            [0.0, 1.0, 0.0],
            [1.5, 0.0, 0.0],
            [9.0, 0.0, 0.0],
        ],
    );
    let told: Vec<(Side, f64)> = found.iter().map(|a| (a.side, a.distance)).collect();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    assert!(told[0].0 == Side::Inner && near(told[0].1, -0.5));
    assert!(told[1].0 == Side::Inner && near(told[1].1, 0.0));
    assert!(told[2].0 == Side::Outer && near(told[2].1, 0.5));
    assert!(told[3].0 == Side::Outer && near(told[3].1, 5.0));
}

#[test]
fn what_is_no_point_is_refused() {
    let (_, result) = torus();
    let axis = result.medial_axis();
    let error = axis.ask(&[[0.0; 3], [0.0, f64::NAN, 0.0]], &Context::default());
    assert!(matches!(error, Err(Error::Samples(_))));
    assert!(axis.ask(&[], &Context::default()).unwrap().is_empty());
    let none = LabelledBalls::of_shape(&PowerShape::default(), &Context::default()).unwrap();
    let error = MedialAxis::of(&none).ask(&[[0.0; 3]], &Context::default());
    assert_eq!(error, Err(Error::NoInnerBalls));
}
