// SPDX-License-Identifier: MIT OR Apache-2.0
//! Functions of shaders/ that are not compared one by one, and why.

/// Why a function has no twin.
pub enum Why {
    /// The function has no counterpart in Rust, or one that only places, packs, binds or counts.
    Plumbing(#[allow(dead_code, reason = "the text is for whoever reads the list")] &'static str),
    /// A test compares what it does in another way: file, test, and what that is.
    Tested(&'static str, &'static str, #[allow(dead_code, reason = "as above")] &'static str),
}

use Why::{Plumbing, Tested};

const RECORDS: Why = Tested(
    "tests/tracers/lens/records.rs",
    "records_agree_with_integration",
    "records of both tracers against rays integrated in f64, for random observers",
);
const FOOTPRINTS: Why = Tested(
    "tests/tracers/lens/footprints.rs",
    "footprints_agree_with_differences",
    "footprints of both tracers' records against differences of rays integrated in f64",
);
const PICTURES: Why = Tested(
    "tests/tracers/pictures.rs",
    "gpu_and_cpu_pictures_agree",
    "pictures of traced rays, whose records come from textures of neighbours, against the CPU tracer's",
);
const REFINED: Why = Tested(
    "tests/tracers/rings.rs",
    "rings_have_no_gaps_and_as_much_light_as_many_rays_find",
    "refined pictures of both tracers against the light that many rays find",
);
const BLOOM: Why = Tested(
    "tests/tracers/bloom.rs",
    "gpu_and_cpu_pictures_agree",
    "pictures with bloom of both tracers: the grids exist only as whole textures",
);
const METERED: Why = Tested(
    "tests/tracers/metering.rs",
    "gpu_and_cpu_pictures_agree",
    "metered pictures of both tracers, and the stops that they add: counts and blocks exist for whole frames only",
);
const VOLUMES: Why = Tested(
    "tests/tracers/volumes.rs",
    "the_tracers_agree",
    "matter of every kind along the rays of whole pictures, one tracer against the other",
);
const BAKED: Why = Tested(
    "src/gpu/frame/resources/baked.rs",
    "texels_are_those_of_the_cpu",
    "every texel of every level against those of src/emit/baked.rs",
);
const MATTER_VIEWS: Why = Tested(
    "tests/tracers/volumes.rs",
    "the_views_of_matter_agree",
    "I_nu and optical depth of whole pictures, one tracer against the other",
);
const HALF: Why = Tested(
    "tests/tracers/half.rs",
    "the_tracers_agree",
    "media of pixels from blocks, in whole pictures, one tracer against the other",
);
const PYRAMID: Why = Tested(
    "tests/tracers/sky_target.rs",
    "levels_made_on_the_gpu_are_those_of_the_cpu",
    "pictures of maps whose levels are made on the GPU against those of src/sky/map.rs",
);
const OUTPUTS: Why = Tested(
    "tests/tracers/outputs.rs",
    "outputs_are_what_rays_meet",
    "outputs of both tracers against rays integrated in f64, and what alpha leaves of the sky",
);
const OCCLUDER: Why = Tested(
    "tests/tracers/occluder.rs",
    "the_tracers_agree",
    "pictures behind things of any shape, one tracer against the other",
);
const NO_VOLUMES: Why = Plumbing("a hook that does nothing where no emitter with depth is");
const ENTRY: Why = Plumbing("a kernel: it hands what others compute from one to the next");
const HOOK: Why = Plumbing("a hook: it calls the one function that this kernel has for it");
const PUTS: Why = Plumbing("it stores a pixel that `develop` made");
const LIST: Why = Plumbing("it keeps a list of pixels, which the CPU tracer does not need");

/// Fragment, functions, why.
pub const EXCUSED: &[(&str, &str, Why)] = &[
    ("bloom/base", "between gather", BLOOM),
    ("bloom/beam", "light_at both_sides spread_beam", BLOOM),
    ("bloom/line", "whole_rows row_shares stored_rows row_kept", BLOOM),
    ("bloom/tail", "covered", BLOOM),
    ("bloom/flare", "reflected", BLOOM),
    ("bloom/ghosts", "seen offset inside cell_light ghost_light draw_ghosts", BLOOM),
    ("bloom/reflected", "reflect_light", BLOOM),
    ("bloom/ghosted", "add_ghosts", BLOOM),
    ("bloom/spikes", "cell_light element_light keep spread_line", BLOOM),
    ("bloom/spiked", "kept_light add_line", BLOOM),
    ("bloom/gather", "kernel coverage tap_weight between gathered_within gather", BLOOM),
    ("bloom/glare", "tile_light", BLOOM),
    ("bloom/upsample", "between upsample", BLOOM),
    ("metering/measure", "count_cell measure", METERED),
    ("metering/expose", "expose", METERED),
    ("metering/smooth", "weighted smooth_blocks", METERED),
    ("metering/metered", "base_at as_metered", METERED),
    ("metering/none", "as_metered", Plumbing("it leaves light as it is")),
    ("emit/disk", "disk_at_crossing disk_structure disk_opacity", Plumbing("the twin of `pixel_light` calls it")),
    ("emit/shape", "has_shape", Plumbing("it asks what a kernel was compiled for")),
    ("emit/plane", "emitted_at_crossing structure_at_crossing", Plumbing("the twin of `pixel_light` calls it")),
    ("emit/volumes", "begin_medium next_part add_part width_at cut_of weight_of add_piece coefficients_at", VOLUMES),
    ("emit/course", "step_course drag_slope delay_slope", VOLUMES),
    ("emit/free_spot", "spot_centre", VOLUMES),
    ("emit/bake", "bake_texels bake_grain half_bits filament_texel level_variances", BAKED),
    ("emit/layers", "is_dark begin_layers next_step is_power_law slow_at slow_course places_at colour_of", VOLUMES),
    ("emit/layers", "add_alone add_block add_cells", VOLUMES),
    ("geodesic/rays", "on_part", NO_VOLUMES),
    ("lens/kerr_nodes", "on_part", NO_VOLUMES),
    ("lens/kerr_deferred", "on_part", NO_VOLUMES),
    ("refine/integrated", "on_part medium_before", VOLUMES),
    ("traced/pixels", "on_part keep_medium light_table baked_factor", VOLUMES),
    ("traced/pixels", "keep_nothing_more", HALF),
    (
        "traced/fill",
        "fill_media fill_quad corner_of block_key row_of cubics_of medium_of_column brightest interpolate",
        HALF,
    ),
    ("lens/media", "set_media_pixel medium_before", HALF),
    ("traced/blocks", "trace_blocks", HALF),
    ("traced/listed", "trace_listed", ENTRY),
    ("traced/each", "trace_pixels", ENTRY),
    ("traced/own_rays", "take_own_rays note_own_ray own_ray_count own_ray", LIST),
    ("traced/record", "medium_before", VOLUMES),
    ("shade/shade", "seen_matter", MATTER_VIEWS),
    ("film/develop", "develop_tile", ENTRY),
    ("film/develop_rows", "develop_tile", ENTRY),
    ("film/light", "write_pixel", BLOOM),
    ("film/packed", "write_pixel", PUTS),
    ("film/packed_rows", "keep_words write_pixel write_rows", PUTS),
    ("film/screen", "write_pixel", PUTS),
    ("film/image_rgba16f", "write_pixel", PUTS),
    ("film/image_rgba32f", "write_pixel", PUTS),
    ("film/image_r32f", "write_pixel", PUTS),
    ("film/summed", "tile_light", Plumbing("it reads the sum of a tile's samples")),
    ("geodesic/rays", "on_crossing trace_rays", Plumbing("it unpacks and packs what `trace` takes and gives")),
    ("lens/kerr_flags", "place value", Plumbing("it reads a node beside a cell")),
    ("lens/kerr_flags", "fourth patch_of stretch_of sky_is_good crossing_flags pattern_is_good flag_cells", RECORDS),
    ("lens/kerr_flags", "nearest_u margin_of is_inside_disk", RECORDS),
    ("lens/kerr", "kerr_reach_inwards", RECORDS),
    ("lens/kerr_nodes", "trace_nodes store_crossing crossing_delay chart_turn delay_over", RECORDS),
    ("lens/kerr_nodes", "on_crossing", Plumbing("a hook that does nothing here")),
    ("lens/kerr_nodes", "store_next", Plumbing("it packs crossings by fours")),
    ("lens/kerr_pixel", "ray_record with_sky next_crossing more_crossings", HOOK),
    ("lens/kerr_pixel", "defer_pixel", LIST),
    ("lens/kerr_record", "interpolate with_looked_up_sky next_looked_up add_pattern edges_of_pixel", RECORDS),
    ("lens/kerr_record", "looked_up_change place_change", FOOTPRINTS),
    ("lens/kerr_deferred", "on_crossing ray_record with_sky next_crossing more_crossings", RECORDS),
    ("lens/schwarzschild_columns", "fill_columns", RECORDS),
    ("lens/schwarzschild_ends", "find_ends", RECORDS),
    (
        "lens/schwarzschild_record",
        "ray_record with_sky next_crossing column_at complete edges_of_pixel along_plane across_plane",
        RECORDS,
    ),
    ("lens/schwarzschild_record", "u_change", FOOTPRINTS),
    ("lens/schwarzschild_record", "more_crossings rewind_crossings sample_turn defer_pixel", HOOK),
    ("lens/each_deferred", "each_deferred", ENTRY),
    ("records/each_pixel", "each_pixel", ENTRY),
    ("film/each_pixel_rows", "each_pixel", ENTRY),
    ("records/export", "export_place take_record", Plumbing("it puts records into a buffer, for tests")),
    ("records/edges", "list_place note_edges note_ragged listed_pixels listed_pixel", LIST),
    ("refine/integrated", "on_crossing integrated_record azimuth_turned more_integrated next_integrated", REFINED),
    ("refine/kerr", "ray_record with_sky sample_turn next_crossing more_crossings rewind_crossings", REFINED),
    ("refine/refine", "refine refine_sample needs_strips", REFINED),
    ("refine/refine", "baked_factor", VOLUMES),
    ("refine/refine", "seen_crossing seen_emission lit_crossing seen_sky go_to_cell", REFINED),
    ("refine/strips", "corrected_place", REFINED),
    ("refine/refine", "cell_footprint change_of_sky change_of_turn has_escaped change_of_place", REFINED),
    ("refine/refine", "beside_cell crossing_in in_quarters", Plumbing("it finds a lane")),
    ("refine/traced", "ray_record with_sky sample_turn next_crossing more_crossings rewind_crossings", REFINED),
    ("shade/only", "take_light", HOOK),
    ("shade/outputs", "light_table put_output to_scene without_crossing take_record", OUTPUTS),
    ("shade/outputs", "depth_of crossing_output ray_output", OUTPUTS),
    ("sky/pyramid", "column_light make_level", PYRAMID),
    ("sky/source_whole", "source_row source_word", Plumbing("it finds a word")),
    ("sky/source_parts", "source_row source_word", Plumbing("it finds a word")),
    ("emit/occluder_rows", "take_distances", Plumbing("it copies")),
    ("shade/packed_outputs", "put_numbers wanted_output output_count output_crossings", HOOK),
    // The text that src/gpu/kernel/wgsl.rs writes for a frame's own outputs.
    ("shade/outputs", "put_numbers wanted_output output_count output_crossings", HOOK),
    ("records/record", "crossing_place crossing_distance", OUTPUTS),
    ("emit/occluder", "set_occluder opaque_u_at", OCCLUDER),
    ("emit/shown_part", "beyond_occluder shown_stretch", OCCLUDER),
    ("shade/shade", "is_occluded", OCCLUDER),
    ("emit/plane", "plane_opacity", OUTPUTS),
    ("shade/record", "take_record seen_crossing seen_emission lit_crossing seen_sky", HOOK),
    (
        "shade/shade",
        "sampled",
        Tested(
            "tests/tracers/sky.rs",
            "gpu_and_cpu_pictures_agree",
            "pictures of maps that a sampler filters, against the CPU tracer's",
        ),
    ),
    ("shade/sample", "take_light", Plumbing("it adds a sample's light to the sum of those before")),
    ("traced/count", "count_steps", Plumbing("it sums the steps of all rays")),
    (
        "traced/footprints",
        "set_traced_pixel traced_neighbours crossing_of_order",
        Plumbing("it finds a record in textures"),
    ),
    ("traced/footprints", "sky_footprint derivative_of_direction widest_turn derivative_of_place", PICTURES),
    ("traced/pixels", "on_crossing trace_pixel", PICTURES),
    (
        "traced/record",
        "ray_record with_sky next_crossing more_crossings is_steep edge_between edges_of_pixel",
        PICTURES,
    ),
    ("traced/record", "defer_pixel", HOOK),
    ("window/present", "cover show", Plumbing("it shows a texture in a window")),
];
