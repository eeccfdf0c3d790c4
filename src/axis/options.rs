//! What may be said about simplifying a medial axis.

use crate::error::Error;

/// How a medial axis is simplified. The default takes nothing out.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SimplifyOptions {
    /// Balls whose touching samples are all within this distance of each
    /// other are unstable and go (section 7.3): a length in the units of the
    /// balls, at least 0. With 0 only balls go whose samples are known to be at one place.
    pub eps: Option<f64>,
    /// Balls contained in a larger one grown by this length go (section 7.3);
    /// at least 0.
    pub delta: Option<f64>,
    /// Balls go whose samples fit into a ball of less than this radius: the
    /// lambda-medial axis (Chazal and Lieutier 2005). A length, at least 0.
    pub lambda: Option<f64>,
    /// Balls go whose samples are seen from the centre under less than this
    /// angle in degrees (Foskey, Lin and Manocha 2003); in [0, 180].
    pub angle: Option<f64>,
    /// Scale axis (Giesen, Miklos, Pauly and Wormser 2009): balls go that the
    /// others cover when all are grown by this factor; in [1, 10].
    pub scale: Option<f64>,
    /// Angle in degrees, in [0, 90], and ratio, at least 0, of Dey and Zhao
    /// (2003; they take 22.5 and 8): balls stay whose samples are seen under
    /// more than twice the angle, or are farther apart than so many spacings.
    /// Their condition asks for each pair of samples of a ball; here the pair
    /// farthest apart decides, the direction to the centre is the
    /// normal, and the spacing stands for the radius of the triangles around.
    pub dey_zhao: Option<[f64; 2]>,
    /// At most so many balls of the side wanted: those that hold all others
    /// when grown by the least length, then moved to fit the samples of
    /// those they stand for, where the samples are known. At least 1.
    pub most: Option<usize>,
    /// Refuse what would change the Betti numbers of the shape.
    pub keep_topology: bool,
}

impl Default for SimplifyOptions {
    fn default() -> SimplifyOptions {
        SimplifyOptions {
            eps: None,
            delta: None,
            lambda: None,
            angle: None,
            scale: None,
            dey_zhao: None,
            most: None,
            keep_topology: true,
        }
    }
}

impl SimplifyOptions {
    /// Whether every value is in its range.
    ///
    /// # Errors
    /// [`Error::Option`].
    pub fn validate(&self) -> Result<(), Error> {
        let length = "a length of at least 0";
        let [steep, far] = match self.dey_zhao {
            Some(both) => both.map(Some),
            None => [None; 2],
        };
        let most = self.most.map(|n| n as f64);
        let ranges = [
            ("eps", self.eps, [0.0, f64::MAX], length),
            ("delta", self.delta, [0.0, f64::MAX], length),
            ("lambda_medial", self.lambda, [0.0, f64::MAX], length),
            (
                "angle",
                self.angle,
                [0.0, 180.0],
                "an angle of 0 to 180 degrees",
            ),
            ("scale", self.scale, [1.0, 10.0], "a factor of 1 to 10"),
            (
                "dey_zhao",
                steep,
                [0.0, 90.0],
                "an angle of 0 to 90 degrees",
            ),
            ("dey_zhao", far, [0.0, f64::MAX], "a ratio of at least 0"),
            ("balls", most, [1.0, f64::MAX], "at least 1"),
        ];
        for (name, value, [low, high], expected) in ranges {
            if let Some(value) = value.filter(|v| !(*v >= low && *v <= high)) {
                return Err(Error::Option {
                    name,
                    value,
                    expected,
                });
            }
        }
        Ok(())
    }
}
