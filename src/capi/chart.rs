// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrChart: the charts in which places, directions and times are told.

use super::pointer::unknown;
use crate::error::Result;
use crate::scene::Chart;

/// How azimuths and times are told, and the triad that directions and velocities are told along. Radii and polar
/// angles are Boyer and Lindquist's in both. RAIN is regular at both horizons for all that falls in, and needed at and
/// inside a spinning hole's. Without spin azimuths do not differ, and the triad at and inside the horizon is that of
/// RAIN. docs/cameras.md. @since 0.2.0
pub type BhrChart = i32;
/// Boyer and Lindquist's ph and t, and the triad of the static observer (ZAMO).
pub const BHR_CHART_STATIC: BhrChart = 0;
/// Doran's, and the triad of the rain observer, who falls from rest at infinity.
pub const BHR_CHART_RAIN: BhrChart = 1;

/// `what`: whose chart it is, for the message. Errors: INVALID_ARGUMENT for a value that is none.
pub(super) fn chart(value: BhrChart, what: &str) -> Result<Chart> {
    Ok(match value {
        BHR_CHART_STATIC => Chart::Static,
        BHR_CHART_RAIN => Chart::Rain,
        _ => return unknown(value, &format!("{what} chart"), "BHR_CHART_STATIC (0) and BHR_CHART_RAIN (1)"),
    })
}
