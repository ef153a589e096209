// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every parameter of a scene by name, for files that say how they were made. The names are those of the C structs'
//! fields; enumerations go by the words of their constants. A field that is new has to be named here: all structs are
//! taken apart without a rest, but for choices that are no host's.

use super::camera::Frustum;
use super::{Camera, Disk, Film, Hole, HotSpot, Quality, Region, Scene, Sky, Volume};
use crate::image::Attribute;
use glam::DVec3;
use std::fmt::Debug;

/// A list of parameters that grows.
#[derive(Default)]
struct Parameters(Vec<(String, Attribute)>);

impl Parameters {
    fn put(&mut self, name: impl Into<String>, value: Attribute) {
        self.0.push((name.into(), value));
    }

    fn numbers<const N: usize>(&mut self, of: &str, numbers: [(&str, f64); N]) {
        for (name, number) in numbers {
            self.put(format!("{of}.{name}"), Attribute::Number(number));
        }
    }

    fn vector(&mut self, name: &str, v: &[f64]) {
        let text = v.iter().map(|number| number.to_string()).collect::<Vec<_>>().join(" ");
        self.put(name, Attribute::Text(text));
    }

    /// The word of an enumeration's constant: `FreeFall` is FREE_FALL.
    fn word(&mut self, name: String, value: &dyn Debug) {
        let mut word = String::new();
        for c in format!("{value:?}").chars() {
            if c.is_uppercase() && !word.is_empty() {
                word.push('_');
            }
            word.extend(c.to_uppercase());
        }
        self.put(name, Attribute::Text(word));
    }
}

fn flag(on: bool) -> f64 {
    f64::from(u8::from(on))
}

/// How a frame was made: all parameters of its scene, without pictures, which may be large.
pub struct Made {
    scene: Scene,
    has_map: bool,
    region: Region,
}

impl Scene {
    /// The scene as it is now, for a frame of which an image shows `region`.
    pub fn made(&self, region: &Region) -> Made {
        let has_map = self.sky_map.is_some() || self.sky_picture.is_some();
        let mut scene = self.clone();
        (scene.sky_map, scene.sky_picture, scene.occluder, scene.given_stars) = (None, None, None, None);
        Made { scene, has_map, region: *region }
    }
}

impl Made {
    pub fn region(&self) -> Region {
        self.region
    }

    /// All of them, in order.
    pub fn parameters(&self) -> Vec<(String, Attribute)> {
        let mut list = Parameters::default();
        let Region { full_width, full_height, x, y } = self.region;
        let scene = &self.scene;
        let region = [("full_width", full_width), ("full_height", full_height), ("x", x), ("y", y)];
        list.numbers("bhr.region", region.map(|(name, number)| (name, number.into())));
        let Hole { mass, spin, axis } = scene.hole;
        list.numbers("bhr.hole", [("mass", mass), ("spin", spin)]);
        list.vector("bhr.hole.axis", &axis.to_array());
        scene.put_camera(&mut list);
        list.numbers("bhr", [("time", scene.time), ("effects", scene.effects.0.into())]);
        list.word("bhr.view".into(), &scene.view);
        match &scene.disk {
            Some(disk) => put_disk(&mut list, disk),
            None => list.put("bhr.disk", Attribute::Text("NONE".into())),
        }
        scene.volumes.iter().zip(0..).for_each(|(volume, i)| put_volume(&mut list, volume, i));
        scene.hot_spots.iter().zip(0..).for_each(|(spot, i)| put_hot_spot(&mut list, spot, i));
        scene.put_sky(self.has_map, &mut list);
        scene.put_film_and_quality(&mut list);
        list.0
    }
}

impl Scene {
    fn put_camera(&self, list: &mut Parameters) {
        let Camera {
            projection,
            position,
            forward,
            up,
            fov_y,
            motion,
            velocity,
            frustum: Frustum { left, right, down, up: top },
            jitter,
            eye,
            eye_distance,
        } = self.camera;
        list.word("bhr.camera.projection".into(), &projection);
        list.word("bhr.camera.motion".into(), &motion);
        list.word("bhr.camera.eye".into(), &eye);
        let tangents = [("tan_left", left), ("tan_right", right), ("tan_down", down), ("tan_up", top)];
        list.numbers("bhr.camera", [("fov_y", fov_y), ("eye_distance", eye_distance)]);
        list.numbers("bhr.camera", tangents);
        list.vector("bhr.camera.jitter", &jitter.to_array());
        let vectors: [(&str, DVec3); 4] =
            [("position", position), ("forward", forward), ("up", up), ("velocity", velocity)];
        vectors.iter().for_each(|(name, v)| list.vector(&format!("bhr.camera.{name}"), &v.to_array()));
    }

    fn put_sky(&self, has_map: bool, list: &mut Parameters) {
        let Sky { flags, stars_brightness, map_brightness, orientation, seed } = self.sky;
        let numbers = [
            ("flags", flags.into()),
            ("stars_brightness", stars_brightness),
            ("map_brightness", map_brightness),
            ("has_map", flag(has_map)),
        ];
        list.numbers("bhr.sky", numbers);
        list.vector("bhr.sky.orientation", &orientation.to_array());
        list.put("bhr.sky.seed", Attribute::Text(seed.to_string()));
    }

    fn put_film_and_quality(&self, list: &mut Parameters) {
        let Film { tone_map, exposure_ev, bloom, beam_fwhm, colour_map, glare_is_optional: _ } = self.film;
        list.numbers("bhr.film", [("exposure_ev", exposure_ev), ("bloom", bloom), ("beam_fwhm", beam_fwhm)]);
        list.word("bhr.film.tone_map".into(), &tone_map);
        list.word("bhr.film.colour_map".into(), &colour_map);
        let Quality {
            method,
            samples_per_pixel,
            max_steps,
            step,
            tolerance,
            max_disk_order,
            render_scale,
            volume_resolution,
            ..
        } = self.quality;
        let numbers = [
            ("samples_per_pixel", samples_per_pixel.into()),
            ("max_steps", max_steps.into()),
            ("step", step),
            ("tolerance", tolerance),
            ("max_disk_order", max_disk_order.into()),
            ("render_scale", render_scale),
        ];
        list.numbers("bhr.quality", numbers);
        list.word("bhr.quality.method".into(), &method);
        list.word("bhr.quality.volume_resolution".into(), &volume_resolution);
    }
}

fn put_disk(list: &mut Parameters, disk: &Disk) {
    let Disk {
        retrograde,
        inner_radius,
        outer_radius,
        temperature,
        opacity,
        brightness,
        turbulence,
        seed,
        reference,
        edge_softness,
        emission_law,
        plunges,
    } = *disk;
    let numbers = [
        ("retrograde", flag(retrograde)),
        ("plunges", flag(plunges)),
        ("inner_radius", inner_radius),
        ("outer_radius", outer_radius),
        ("temperature", temperature),
        ("opacity", opacity),
        ("brightness", brightness),
        ("turbulence", turbulence),
        ("edge_softness", edge_softness),
    ];
    list.numbers("bhr.disk", numbers);
    list.put("bhr.disk.seed", Attribute::Text(seed.to_string()));
    list.word("bhr.disk.reference".into(), &reference);
    list.word("bhr.disk.emission_law".into(), &emission_law);
}

fn put_volume(list: &mut Parameters, volume: &Volume, index: usize) {
    let Volume {
        retrograde,
        power_law,
        shape,
        flow,
        inner_radius,
        outer_radius,
        radius,
        width,
        thickness,
        opening,
        slope,
        absorption,
        temperature,
        temperature_slope,
        spectral_index,
        tint,
        brightness,
        sub_keplerian,
        infall,
        angular_momentum,
        speed,
        turbulence,
        clumping,
        heating,
        seed,
    } = *volume;
    let of = format!("bhr.volume{index}");
    let numbers = [
        ("retrograde", flag(retrograde)),
        ("power_law", flag(power_law)),
        ("inner_radius", inner_radius),
        ("outer_radius", outer_radius),
        ("radius", radius),
        ("width", width),
        ("thickness", thickness),
        ("opening", opening),
        ("slope", slope),
        ("absorption", absorption),
        ("temperature", temperature),
        ("temperature_slope", temperature_slope),
        ("spectral_index", spectral_index),
        ("brightness", brightness),
        ("sub_keplerian", sub_keplerian),
        ("infall", infall),
        ("angular_momentum", angular_momentum),
        ("speed", speed),
        ("turbulence", turbulence),
        ("clumping", clumping),
        ("heating", heating),
    ];
    list.numbers(&of, numbers);
    list.word(format!("{of}.shape"), &shape);
    list.word(format!("{of}.flow"), &flow);
    list.vector(&format!("{of}.tint"), &tint);
    list.put(format!("{of}.seed"), Attribute::Text(seed.to_string()));
}

fn put_hot_spot(list: &mut Parameters, spot: &HotSpot, index: usize) {
    let HotSpot {
        retrograde,
        thermal,
        radius,
        size,
        azimuth,
        absorption,
        temperature,
        spectral_index,
        tint,
        brightness,
    } = *spot;
    let of = format!("bhr.hot_spot{index}");
    let numbers = [
        ("retrograde", flag(retrograde)),
        ("thermal", flag(thermal)),
        ("radius", radius),
        ("size", size),
        ("azimuth", azimuth),
        ("absorption", absorption),
        ("temperature", temperature),
        ("spectral_index", spectral_index),
        ("brightness", brightness),
    ];
    list.numbers(&of, numbers);
    list.vector(&format!("{of}.tint"), &tint);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{FlowLaw, Motion};

    #[test]
    fn every_parameter_has_a_name_of_its_own_that_every_file_takes() {
        let mut scene = Scene::default();
        (0..Volume::MOST).for_each(|_| scene.volumes.push(Volume { flow: FlowLaw::Outflow, ..Volume::default() }));
        (0..HotSpot::MOST).for_each(|_| scene.hot_spots.push(HotSpot::default()));
        scene.camera.motion = Motion::FreeFall;
        scene.hole.spin = 0.1;
        let list = scene.made(&Region { full_width: 3, full_height: 4, x: 1, y: 2 }).parameters();
        let mut names = list.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>();
        // OpenEXR's readers before 2.0 take names of 31 bytes.
        assert!(names.iter().all(|name| name.len() <= 31), "{names:?}");
        let value = |name: &str| list.iter().find(|(of, _)| of == name).map(|(_, value)| value.clone());
        assert_eq!(value("bhr.hole.spin"), Some(Attribute::Number(0.1)));
        assert_eq!(value("bhr.camera.motion"), Some(Attribute::Text("FREE_FALL".into())));
        assert_eq!(value("bhr.camera.position"), Some(Attribute::Text("0 26 2.5".into())));
        assert_eq!(value("bhr.region.y"), Some(Attribute::Number(2.0)));
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
