// SPDX-License-Identifier: MIT OR Apache-2.0
// High dynamic range: light of a film to the codes of PQ and HLG. Mirrors src/film/hdr.rs, where the formulas, sources
// and reasons are.

#import constants
#import film/params

fn pq_encode(light: f32) -> f32 {
    let power = pow(light, PQ_M1);
    return pow((PQ_C1 + PQ_C2 * power) / (1.0 + PQ_C3 * power), PQ_M2);
}

fn pq_decode(code: f32) -> f32 {
    let root = pow(code, 1.0 / PQ_M2);
    return pow(max(root - PQ_C1, 0.0) / (PQ_C2 - PQ_C3 * root), 1.0 / PQ_M1);
}

fn rolled_off(code: f32) -> f32 {
    let t = clamp((code - film.hdr_knee) / max(1.0 - film.hdr_knee, 1e-6), 0.0, 1.0);
    let t2 = t * t;
    let t3 = t2 * t;
    let rolled = (2.0 * t3 - 3.0 * t2 + 1.0) * film.hdr_knee + (t3 - 2.0 * t2 + t) * (1.0 - film.hdr_knee)
        + (3.0 * t2 - 2.0 * t3) * film.hdr_peak;
    return select(min(rolled, film.hdr_peak), code, code <= film.hdr_knee);
}

fn display_light(scene: vec3<f32>) -> vec3<f32> {
    let given = min(scene, vec3<f32>(MAX_SCENE_LIGHT)) * film.hdr_white;
    let wide = vec3<f32>(
        dot(film.primaries_red.xyz, given), dot(film.primaries_green.xyz, given), dot(film.primaries_blue.xyz, given));
    let light = max(wide, vec3<f32>(0.0));
    let brightest = max(max(light.x, light.y), light.z);
    let shown = pq_decode(rolled_off(pq_encode(min(brightest, 1.0))));
    let factor = select(0.0, shown / brightest, brightest > 0.0);
    return light * factor;
}

fn hlg_encode(light: f32) -> f32 {
    let bright = HLG_A * log(max(12.0 * light - HLG_B, 1e-6)) + HLG_C;
    return select(bright, sqrt(3.0 * light), light <= 1.0 / 12.0);
}

fn pq_codes(scene: vec3<f32>) -> vec3<f32> {
    let light = min(display_light(scene), vec3<f32>(1.0));
    return min(vec3<f32>(pq_encode(light.x), pq_encode(light.y), pq_encode(light.z)), vec3<f32>(1.0));
}

fn hlg_codes(scene: vec3<f32>) -> vec3<f32> {
    let light = display_light(scene) / film.hlg_peak;
    let luminance = max(dot(vec3<f32>(0.2627, 0.678, 0.0593), light), 1e-12);
    let relative = min(light * pow(luminance, film.hlg_exponent), vec3<f32>(1.0));
    return min(vec3<f32>(hlg_encode(relative.x), hlg_encode(relative.y), hlg_encode(relative.z)), vec3<f32>(1.0));
}
