// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrChart: the charts in which places, directions and times are told.

use super::pointer::unknown;
use crate::error::Result;
use crate::scene::Chart;

/// A chart: how azimuths and times are told, and the triad that directions and velocities are told along. Radii and
/// polar angles are Boyer and Lindquist's in both, and without spin so are azimuths. @since 0.2.0
pub type BhrChart = i32;
/// Azimuth ph and time t of Boyer and Lindquist, and the triad of the local static observer (ZAMO). Outside the
/// horizon only; at and inside a spin-0 horizon the triad is the rain observer's. @since 0.2.0
pub const BHR_CHART_STATIC: BhrChart = 0;
/// Azimuth and time T of Doran (2000), and the triad of the rain observer, who falls from rest at infinity with E =
/// 1 and L = Q = 0. It is regular at both horizons for all that falls in, and needed at and inside a spinning
/// hole's horizon. The rain observer's azimuth stays as it is, and T is the time by that observer's clock. Far away
/// azimuths are those of STATIC. @since 0.2.0
pub const BHR_CHART_RAIN: BhrChart = 1;

/// `what`: whose chart it is, for the message. Errors: INVALID_ARGUMENT for a value that is none.
pub(super) fn chart(value: BhrChart, what: &str) -> Result<Chart> {
    Ok(match value {
        BHR_CHART_STATIC => Chart::Static,
        BHR_CHART_RAIN => Chart::Rain,
        _ => return unknown(value, &format!("{what} chart"), "BHR_CHART_STATIC (0) and BHR_CHART_RAIN (1)"),
    })
}
