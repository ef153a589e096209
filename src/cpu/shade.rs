// SPDX-License-Identifier: MIT OR Apache-2.0
//! Turns ray records into linear radiance, or a view's value, in f64. Mirrored by `shaders/shade/shade.wgsl`. Does not
//! know how the records were made.

use crate::emit::medium::media_in_order;
use crate::emit::{Crossing, Emission, PlaneLight};
use crate::error::Result;
use crate::physics::orbit::zamo_frequency;
use crate::physics::trace::Fate;
use crate::scene::observer::Lens;
use crate::scene::occluder::Shown;
use crate::scene::record::{Record, UNKNOWN_DIRECTION};
use crate::scene::{EffectStrengths, Scene, View};
use crate::sky::{SkyMap, StarIndex, least_patch, shifted_map_light, under_grid};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// The part of a scene that shading needs.
pub struct Shader<'a> {
    scene: &'a Scene,
    lens: &'a Lens,
    plane: PlaneLight,
    /// How strongly effects show.
    effects: EffectStrengths,
    /// `None`: no stars.
    stars: Option<Arc<StarIndex>>,
    least_patch: f64,
    /// The Milky Way and the host's map, where they are shown.
    maps: [Option<&'a SkyMap>; 2],
    grid: bool,
    chart_to_sky: DMat3,
    transparent: bool,
}

/// A shader that sees matter `moment` after the frame's time, M.
#[derive(Clone, Copy)]
pub struct Shading<'s, 'a> {
    pub shader: &'s Shader<'a>,
    pub moment: f64,
}

impl Shading<'_, '_> {
    /// The pixel of the record at (x, y): light and alpha, or the view's value first; nothing where the projection
    /// shows nothing.
    pub fn shade_record(self, here: &Record, x: f64, y: f64) -> [f64; 4] {
        self.shade_record_with(here, x, y, |crossing, open| (self.shader.emission(here, crossing, open), *crossing))
    }

    /// The light of a record, each of whose crossings adds what `seen_emission` gives in the place of `emission`.
    pub fn shade_record_with(
        self,
        here: &Record,
        x: f64,
        y: f64,
        seen_emission: impl Fn(&Crossing, f64) -> (Emission, Crossing),
    ) -> [f64; 4] {
        let Self { shader, moment } = self;
        match (shader.scene.view, shader.lens.mapping.has_look_direction(x, y)) {
            (View::Light, true) => shader.pixel_light(here, shader.shown(x, y), moment, seen_emission),
            (View::Light, false) => [0.0; 4],
            (_, true) => [shader.view_value(here, x, y), 0.0, 0.0, 1.0],
            (_, false) => [f64::NAN, 0.0, 0.0, 1.0],
        }
    }
}

impl<'a> Shader<'a> {
    /// Errors: OUT_OF_MEMORY.
    pub fn new(scene: &'a Scene, lens: &'a Lens, stars: Arc<StarIndex>, transparent: bool) -> Result<Self> {
        let milky_way = scene.shows_milky_way().then(SkyMap::milky_way).transpose()?;
        Ok(Self {
            scene,
            lens,
            plane: PlaneLight::new(&scene.emitters())?,
            effects: scene.shown_effects(),
            stars: scene.shows_stars().then_some(stars),
            least_patch: least_patch(lens.mapping.pixel_angle),
            maps: [milky_way, scene.shown_map().map(|map| map.texels()).transpose()?],
            grid: scene.shows_grid(),
            chart_to_sky: scene.chart_to_sky(),
            transparent,
        })
    }

    /// The part of the ray through (x, y) that the host's things leave; `None`: there are none.
    fn shown(&self, x: f64, y: f64) -> Option<Shown> {
        let occluder = self.scene.occluder.as_ref()?;
        let distance = occluder.at(x, y) / self.scene.hole.mass;
        Some(Shown::new(distance, self.lens.closest_approach(x, y), occluder.lensed))
    }

    /// Linear premultiplied Rec. 709 and alpha = 1 - the sky's share. `shown`: the part of the ray that is seen; where
    /// it ends, what is behind takes the sky's place. `moment`: the time at which it is seen less that of the frame, M.
    fn pixel_light(
        &self,
        here: &Record,
        shown: Option<Shown>,
        moment: f64,
        seen_emission: impl Fn(&Crossing, f64) -> (Emission, Crossing),
    ) -> [f64; 4] {
        let eye = self.lens.place.e_r * self.lens.place.r;
        let mut light = [0.0; 3];
        let mut open = 1.0;
        let mut media = here.media.iter();
        let mut pass = |light: &mut [f64; 3], open: &mut f64| {
            if let Some(medium) = media.next() {
                (0..3).for_each(|c| light[c] += *open * medium.light[c]);
                *open *= medium.through;
            }
        };
        for crossing in &here.crossings {
            pass(&mut light, &mut open);
            if open <= 0.0 {
                break;
            }
            if shown.is_some_and(|shown| !shown.shows(crossing, eye)) {
                continue;
            }
            let (emission, lit) = seen_emission(crossing, open);
            if emission.opacity > 0.0 {
                let structure = self.plane.structure(&lit, moment);
                (0..3).for_each(|c| light[c] += structure * emission.light[c]);
                open *= 1.0 - emission.opacity;
            }
        }
        pass(&mut light, &mut open);
        if shown.is_some_and(|shown| shown.ends) {
            return [light[0], light[1], light[2], 1.0 - open];
        }
        if here.fate != Fate::Escaped {
            return [light[0], light[1], light[2], 1.0];
        }
        if !self.transparent && open > 0.0 {
            let rgb = self.sky_light(here);
            (0..3).for_each(|c| light[c] += open * rgb[c]);
        }
        [light[0], light[1], light[2], 1.0 - open]
    }

    /// The light that a crossing adds to a ray of which the share `open` comes this far, without structure, and its
    /// opacity.
    pub fn emission(&self, here: &Record, crossing: &Crossing, open: f64) -> Emission {
        let gravity = || nu_static_observer(self.lens, here) / self.nu_zamo_in_plane(crossing.u, here);
        let mu = (here.polar_momentum * crossing.u * crossing.g).min(1.0);
        self.plane.at_crossing(crossing, self.effects.visible_shift(crossing.g, gravity), mu, open)
    }

    /// nu(ZAMO at a place of the plane).
    fn nu_zamo_in_plane(&self, u: f64, ray: &Record) -> f64 {
        zamo_frequency(self.scene.hole.spin, u, 0.0, ray.energy, ray.angular_momentum)
    }

    fn sky_light(&self, here: &Record) -> [f64; 3] {
        let gravity = || nu_static_observer(self.lens, here) / here.energy;
        let shift = self.effects.visible_shift(here.sky_redshift, gravity);
        let d = self.chart_to_sky * here.direction;
        // Differences of unit vectors leave the tangent plane where they are large; `footprint_of` of the WGSL brings
        // them back too.
        let tangent = |change: DVec3| change - d * d.dot(change);
        let [dx, dy] = here.footprint.map(|change| match change == UNKNOWN_DIRECTION {
            true => change,
            false => tangent(self.chart_to_sky * change),
        });
        let sky = &self.scene.sky;
        let mut light = self.stars.as_deref().map_or([0.0; 3], |stars| {
            stars
                .star_light(d, [dx, dy], shift.colour, shift.beaming, self.least_patch)
                .map(|v| v * sky.stars_brightness)
        });
        for map in self.maps.iter().flatten() {
            let rgb = shifted_map_light(map.light(d, dx, dy), shift.colour, shift.beaming);
            (0..3).for_each(|c| light[c] += rgb[c] * sky.map_brightness);
        }
        if self.grid { under_grid(light, d, dx, dy) } else { light }
    }

    /// The value that the view shows of the record at (x, y); NaN where there is none.
    fn view_value(&self, here: &Record, x: f64, y: f64) -> f64 {
        let first = here.crossings.first();
        match (self.scene.view, here.fate) {
            (View::Redshift, fate) => match first {
                Some(crossing) => crossing.g,
                None if fate == Fate::Escaped => here.sky_redshift,
                None => f64::NAN,
            },
            (View::Order, fate) => match (first, fate) {
                (Some(crossing), _) => f64::from(crossing.order),
                (None, Fate::Escaped) => -1.0,
                (None, Fate::Captured) => -2.0,
                (None, Fate::Unresolved | Fate::Hidden) => f64::NAN,
            },
            (View::Deflection, Fate::Escaped) => {
                let look = self.lens.placed(self.lens.look_direction(x, y));
                look.cross(here.direction).length().atan2(look.dot(here.direction))
            }
            (View::Deflection, _) => f64::NAN,
            (View::Steps, _) => f64::from(here.steps),
            (View::Metric, _) if here.plane_u > 0.0 => 1.0 - 2.0 * here.plane_u,
            (View::Metric, _) => f64::NAN,
            // Matter that falls piles up before the horizon without end, so that a captured ray's depth has no value.
            (View::OpticalDepth, Fate::Escaped) => here.media.iter().map(|medium| medium.depth).sum(),
            (View::OpticalDepth, _) => f64::NAN,
            (View::Intensity, _) => media_in_order(&here.media).intensity,
            // Light has no value; `pixel_light` shows it.
            (View::Light, _) => f64::NAN,
        }
    }
}

/// nu(static observer or ZAMO where the camera is), for E and L scaled to nu_local = 1; in the rain frame inside the
/// horizon, its own.
fn nu_static_observer(lens: &Lens, ray: &Record) -> f64 {
    let observer = lens.observer.frame.static_observer();
    observer.map_or(1.0, |observer| observer.frequency(ray.energy, ray.angular_momentum))
}
