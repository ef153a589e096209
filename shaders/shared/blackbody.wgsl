// SPDX-License-Identifier: MIT OR Apache-2.0
// Thermal light as the eye sees it: mirrors src/physics/blackbody.rs (BlackbodyTable), where the formulas and reasons
// are. Node i of the table, light_table(i), holds rgb / Y and ln(Y / T) + WIEN_TEMPERATURE / T.

#import constants
#requires fn light_table(i: u32) -> vec4<f32>

const BLACKBODY_OFFSET: u32 = 0u;

// The value of the table that begins at entry `first`: rgb / Y, not clamped, and ln(Y / T); MIN_TEMPERATURE <=
// temperature <= MAX_TEMPERATURE.
fn blackbody_lookup(first: u32, temperature: f32) -> vec4<f32> {
    const SCALE = f32(BLACKBODY_SIZE - 1u) * (MIN_TEMPERATURE + COORDINATE_TEMPERATURE);
    let position = SCALE / (temperature + COORDINATE_TEMPERATURE);
    let index = min(u32(position), BLACKBODY_SIZE - 2u);
    let share = position - f32(index);
    let low = light_table(first + index);
    let high = light_table(first + index + 1u);
    var value = low + (high - low) * share;
    value.w -= WIEN_TEMPERATURE / temperature;
    return value;
}

// The rule of colour and beaming: B(g_colour T) g_beaming^4 / g_colour^4, where a luminance of e^log_reference counts
// as 1.
fn shifted_blackbody(temperature: f32, log_reference: f32, g_colour: f32, g_beaming: f32) -> vec3<f32> {
    return shifted_light(BLACKBODY_OFFSET, temperature, log_reference, g_colour, g_beaming);
}

// Thermal light by the rule of colour and beaming, by the table that begins at entry `first`.
fn shifted_light(first: u32, temperature: f32, log_reference: f32, g_colour: f32, g_beaming: f32) -> vec3<f32> {
    let observed = temperature * g_colour;
    // Found in any case: a branch would keep GPUs from waiting for several at once.
    let taken = clamp(observed, MIN_TEMPERATURE, MAX_TEMPERATURE);
    let value = blackbody_lookup(first, taken);
    let beaming = min(g_beaming / g_colour, MAX_BEAMING);
    let gain = (beaming * beaming) * (beaming * beaming);
    let luminance = exp(min(value.w - log_reference, MAX_LN_RATIO)) * gain * taken;
    let shows = observed >= MIN_TEMPERATURE && g_beaming > 0.0;
    return select(vec3<f32>(0.0), into_gamut(value.xyz) * min(luminance, MAX_RATIO), shows);
}

// The luminances of four blackbodies at e^`ln_temperature` K, over e^`log_reference`: `fitted_luminance` of the Rust.
fn blackbody_luminances(ln_temperature: vec4<f32>, log_reference: f32) -> vec4<f32> {
    let inverse = exp(-ln_temperature);
    let x = min(FIT_TEMPERATURE * inverse / (1.0 + FIT_TEMPERATURE * inverse), vec4<f32>(FIT_END));
    var sum = FIT_LUMINANCE[9] * x + FIT_LUMINANCE[8];
    sum = sum * x + FIT_LUMINANCE[7];
    sum = sum * x + FIT_LUMINANCE[6];
    sum = sum * x + FIT_LUMINANCE[5];
    sum = sum * x + FIT_LUMINANCE[4];
    sum = sum * x + FIT_LUMINANCE[3];
    sum = sum * x + FIT_LUMINANCE[2];
    sum = sum * x + FIT_LUMINANCE[1];
    sum = sum * x + FIT_LUMINANCE[0];
    let ln_ratio = sum + ln_temperature - WIEN_TEMPERATURE * inverse - log_reference;
    return exp(min(ln_ratio, vec4<f32>(MAX_LN_RATIO)));
}

// The colour of luminance 1 of a blackbody at e^`ln_temperature` K: `fitted_colour` of the Rust.
fn blackbody_colour(ln_temperature: f32) -> vec3<f32> {
    let inverse = exp(-ln_temperature);
    let x = min(FIT_TEMPERATURE * inverse / (1.0 + FIT_TEMPERATURE * inverse), FIT_END);
    // Loops over constants would read them from memory.
    var blue = FIT_BLUE[9] * x + FIT_BLUE[8];
    blue = blue * x + FIT_BLUE[7];
    blue = blue * x + FIT_BLUE[6];
    blue = blue * x + FIT_BLUE[5];
    blue = blue * x + FIT_BLUE[4];
    blue = blue * x + FIT_BLUE[3];
    blue = blue * x + FIT_BLUE[2];
    blue = blue * x + FIT_BLUE[1];
    blue = blue * x + FIT_BLUE[0];
    var red = FIT_RED[7] * x + FIT_RED[6];
    red = red * x + FIT_RED[5];
    red = red * x + FIT_RED[4];
    red = red * x + FIT_RED[3];
    red = red * x + FIT_RED[2];
    red = red * x + FIT_RED[1];
    red = red * x + FIT_RED[0];
    return into_gamut(vec3<f32>(red, (1.0 - LUMINANCE.x * red - LUMINANCE.z * blue) / LUMINANCE.y, blue));
}

// A colour of luminance 1 mixed with white until no component is negative.
fn into_gamut(rgb: vec3<f32>) -> vec3<f32> {
    let least = min(min(min(rgb.x, rgb.y), rgb.z), 0.0);
    return (rgb - least) / (1.0 - least);
}
