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
/// INVALID_ARGUMENT. A backend may lack a view: then rendering is UNSUPPORTED. docs/views.md has the colours.
pub type BhrView = i32;
/// The picture. The default.
pub const BHR_VIEW_LIGHT: BhrView = 0;
/// The redshift g of the first crossing within the disk's radii, else that of the sky; NaN where the ray is captured
/// without such a crossing.
pub const BHR_VIEW_REDSHIFT: BhrView = 1;
/// The number of the image, 0, 1, 2 ..., of the first crossing within the disk's radii; -1 sky; -2 captured.
pub const BHR_VIEW_ORDER: BhrView = 2;
/// The angle between look direction and sky direction, radians; NaN where the ray is captured.
pub const BHR_VIEW_DEFLECTION: BhrView = 3;
/// The integration steps of the pixel's ray; 0 where it was looked up (BHR_METHOD_AUTO).
pub const BHR_VIEW_STEPS: BhrView = 4;
/// -g_tt = 1 - 2 M / r at the first crossing of the equatorial plane; NaN without one.
pub const BHR_VIEW_METRIC: BhrView = 5;
/// The optical depth of all volumes and hot spots, as in BhrTransfer; NaN unless the ray escapes. @since 0.2.0
pub const BHR_VIEW_OPTICAL_DEPTH: BhrView = 6;
/// The intensity of volumes and hot spots with a power law, as in BhrTransfer. @since 0.2.0
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

/// The number of a view.
pub(super) fn number(view: View) -> BhrView {
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

/// Sets the view. Default BHR_VIEW_LIGHT.
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

/// Reads the view as it is set. @since 0.2.0
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
