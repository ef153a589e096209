//! BhrView: what a pixel shows.

use super::context::BhrContext;
use super::entry::on_context;
use super::pointer::unknown;
use super::status::BhrStatus;
use crate::scene::View;

/// What a pixel shows. 8-bit formats and windows: false colour, without film. R32F: the value, NaN where there is
/// none. RGBA16F and RGBA32F hold LIGHT only, R32F every view but LIGHT: else rendering is INVALID_ARGUMENT. A
/// backend may not have every view: then rendering is UNSUPPORTED.
pub type BhrView = i32;
/// The picture. The default.
pub const BHR_VIEW_LIGHT: BhrView = 0;
/// g of the first crossing within the disk's radii, else the sky's redshift.
pub const BHR_VIEW_REDSHIFT: BhrView = 1;
/// 0, 1, 2 .. of the first crossing within the disk's radii; -1 sky; -2 captured.
pub const BHR_VIEW_ORDER: BhrView = 2;
/// Angle between look direction and sky direction, radians; NaN captured.
pub const BHR_VIEW_DEFLECTION: BhrView = 3;
/// Integration steps of the pixel's ray; 0 where its ray was looked up (BHR_METHOD_AUTO).
pub const BHR_VIEW_STEPS: BhrView = 4;
/// -g_tt at the first crossing of the equatorial plane; NaN without one.
pub const BHR_VIEW_METRIC: BhrView = 5;

/// Sets the view. Default BHR_VIEW_LIGHT. Errors: INVALID_ARGUMENT for an unknown view.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn bhr_set_view(context: *mut BhrContext, view: BhrView) -> BhrStatus {
    // SAFETY: NULL or valid, by the header's conventions.
    unsafe {
        on_context("bhr_set_view", context, |state| {
            state.renderer.scene.view = match view {
                BHR_VIEW_LIGHT => View::Light,
                BHR_VIEW_REDSHIFT => View::Redshift,
                BHR_VIEW_ORDER => View::Order,
                BHR_VIEW_DEFLECTION => View::Deflection,
                BHR_VIEW_STEPS => View::Steps,
                BHR_VIEW_METRIC => View::Metric,
                _ => return unknown(view, "view", "BHR_VIEW_LIGHT (0) to BHR_VIEW_METRIC (5)"),
            };
            Ok(())
        })
    }
}
