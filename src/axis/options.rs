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
    /// Refuse what would change the Betti numbers of the shape.
    pub keep_topology: bool,
}

impl Default for SimplifyOptions {
    fn default() -> SimplifyOptions {
        SimplifyOptions {
            eps: None,
            delta: None,
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
        let lengths = [("eps", self.eps), ("delta", self.delta)];
        for (name, value) in lengths {
            if let Some(value) = value.filter(|v| !(*v >= 0.0 && v.is_finite())) {
                return Err(Error::Option {
                    name,
                    value,
                    expected: "a length of at least 0",
                });
            }
        }
        Ok(())
    }
}
