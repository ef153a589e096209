// SPDX-License-Identifier: MIT OR Apache-2.0
//! BhrView: the quantity that pixels show.

use super::call::on_context;
use super::context::BhrContext;
use super::pointer::{Out, unknown};
use super::status::BhrStatus;
use crate::error::Result;
use crate::scene::View;

/// The quantity that pixels show. 8-bit formats and windows show it in false colour, without film; R32F holds its
/// value, NaN where there is none. RGBA16F and RGBA32F hold LIGHT only, R32F every view but LIGHT: else rendering is
/// INVALID_ARGUMENT. A backend may lack a view: then rendering is UNSUPPORTED.
///
/// For a host's legend, the colours of values: s goes from 0 to 1 over the range that each view states, and stays at 0
/// and 1 beyond it. The sequential map is CIELAB L = 15 + 76 s, a = 11 + 56 cos w, b = 21 + 56 sin w, w = 4.76 + 3.78
/// s: from dark blue over purple, red and orange to light yellow. The diverging map, with m = |2 s - 1|, is L = 95 - 57
/// m and (a, b) = (52.00, 33.77) m below s = 1/2, red, (21.21, -58.26) m above it, blue, with light grey between them.
/// The white is that of Rec. 709, and colours are encoded as sRGB. Equal steps of s are equal steps of colour and of
/// lightness. NaN is grey, (128, 128, 128).
pub type BhrView = i32;
/// The picture. The default.
pub const BHR_VIEW_LIGHT: BhrView = 0;
/// The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is captured
/// without such a crossing. Diverging map, s = 1/2 + ln(g) / (2 ln 3): g = 1/3 .. 3, light grey where nothing is
/// shifted, blue above 1, red below.
pub const BHR_VIEW_REDSHIFT: BhrView = 1;
/// The number of the image, 0, 1, 2 .., of the first crossing within the disk's radii; -1 sky; -2 captured. Sequential
/// map, s = (order + 2) / 5: order 3 and above are one colour.
pub const BHR_VIEW_ORDER: BhrView = 2;
/// The angle between look direction and sky direction, radians; NaN where the ray is captured. Sequential map, s = 1 +
/// log2(angle / pi) / 6: angles from pi / 64 to pi.
pub const BHR_VIEW_DEFLECTION: BhrView = 3;
/// The integration steps of the pixel's ray; 0 where it was looked up (BHR_METHOD_AUTO). Sequential map, s = log2(steps
/// / 8) / 6: 8 .. 512 steps.
pub const BHR_VIEW_STEPS: BhrView = 4;
/// -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one. Sequential map, s = 1 - sqrt(1 -
/// value): 0, the static limit, and less are its dark end; 1, infinity, its light one.
pub const BHR_VIEW_METRIC: BhrView = 5;
/// The optical depth of all volumes and hot spots along the ray, at the camera's frequency, as in BhrTransfer; NaN
/// unless the ray escapes. The thin disk does not count. Sequential map, s = (log2(value) + 6) / 10: 1/64 .. 16.
/// Since 0.2.0.
pub const BHR_VIEW_OPTICAL_DEPTH: BhrView = 6;
/// The intensity at the camera's frequency of volumes and hot spots with a power law, where they send 1 per M at
/// density 1, as in BhrTransfer. It is what Gold et al. 2020 sum to a flux. The thin disk does not count. Sequential
/// map, s = (log2(value) + 6) / 12: 1/64 .. 64. Since 0.2.0.
pub const BHR_VIEW_INTENSITY: BhrView = 7;

/// The view of this number, which messages call `name`.
pub(super) fn view(number: BhrView, name: &str) -> Result<View> {
    Ok(match number {
        BHR_VIEW_LIGHT => View::Light,
        BHR_VIEW_REDSHIFT => View::Redshift,
        BHR_VIEW_ORDER => View::Order,
        BHR_VIEW_DEFLECTION => View::Deflection,
        BHR_VIEW_STEPS => View::Steps,
        BHR_VIEW_METRIC => View::Metric,
        BHR_VIEW_OPTICAL_DEPTH => View::OpticalDepth,
        BHR_VIEW_INTENSITY => View::Intensity,
        _ => return unknown(number, name, "BHR_VIEW_LIGHT (0) to BHR_VIEW_INTENSITY (7)"),
    })
}

fn number(view: View) -> BhrView {
    match view {
        View::Light => BHR_VIEW_LIGHT,
        View::Redshift => BHR_VIEW_REDSHIFT,
        View::Order => BHR_VIEW_ORDER,
        View::Deflection => BHR_VIEW_DEFLECTION,
        View::Steps => BHR_VIEW_STEPS,
        View::Metric => BHR_VIEW_METRIC,
        View::OpticalDepth => BHR_VIEW_OPTICAL_DEPTH,
        View::Intensity => BHR_VIEW_INTENSITY,
    }
}

/// Sets the view. Default BHR_VIEW_LIGHT. Errors: INVALID_ARGUMENT for an unknown view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_view(context: *mut BhrContext, view: BhrView) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_view", context, |state| {
            state.renderer.scene.view = self::view(view, "view")?;
            Ok(())
        })
    }
}

/// The view as it is set. Since 0.2.0. Errors: INVALID_ARGUMENT for NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_get_view(context: *const BhrContext, out_view: *mut BhrView) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        let view = Out::cleared(out_view);
        on_context("bhr_get_view", context, |state| {
            view.required("out_view")?;
            view.set(number(state.renderer.scene.view));
            Ok(())
        })
    }
}
