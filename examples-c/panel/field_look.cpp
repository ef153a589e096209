// SPDX-License-Identifier: MIT OR Apache-2.0
// field_look.cpp -- see field_look.h.
#include "field_look.h"

#include "vec.h"

#include <algorithm>
#include <cstring>

namespace {

// The widest range of a linear slider, and the largest ratio of its ends that a hand can still set.
constexpr double LINEAR_SPAN = 50.0, LINEAR_RATIO = 100.0;

// Labels for names that are longer than their column, and what bhr.h does not tell.
const struct {
    const Field *list;
    const char  *option, *label; // NULL: the name
    double       high;           // the slider's upper end; 0: by rule
    const char  *zero;           // what 0 stands for; NULL: a number
} SPECIAL[] = {
    {DISK_FIELDS, "--inner-radius", nullptr, 30.0, "innermost"},
    {DISK_FIELDS, "--edge-softness", "soft edges", 0.0, nullptr},
    {VOLUME_FIELDS, "--inner-radius", nullptr, 30.0, "ISCO"},
    {VOLUME_FIELDS, "--temperature-slope", "its slope", 0.0, nullptr},
    {VOLUME_FIELDS, "--spectral-index", "index", 0.0, nullptr},
    {VOLUME_FIELDS, "--sub-keplerian", "sub-Kepler", 0.0, nullptr},
    {VOLUME_FIELDS, "--angular-momentum", "ang. mom.", 0.0, nullptr},
    {HOT_SPOT_FIELDS, "--absorption", nullptr, 100.0, nullptr},
    {HOT_SPOT_FIELDS, "--spectral-index", "index", 0.0, nullptr},
    {SKY_FIELDS, "--stars-brightness", "starlight", 0.0, nullptr},
    {SKY_FIELDS, "--map-brightness", "map's light", 0.0, nullptr},
    {FILM_FIELDS, "--exposure-ev", "exposure", 0.0, nullptr},
    {FILM_FIELDS, "--auto-percentile", "percentile", 0.0, nullptr},
    {FILM_FIELDS, "--auto-target", "its target", 0.0, nullptr},
    {FILM_FIELDS, "--auto-least-ev", "at least", 0.0, nullptr},
    {FILM_FIELDS, "--auto-most-ev", "at most", 0.0, nullptr},
    {FILM_FIELDS, "--auto-adaptation", "adaptation", 0.0, nullptr},
    {FILM_FIELDS, "--beam-fwhm", "beam", 0.0, nullptr},
    {FILM_FIELDS, "--white-balance", "white", 0.0, "off"},
    {FILM_FIELDS, "--shoulder-strength", "shoulder", 0.0, nullptr},
    {FILM_FIELDS, "--shoulder-length", "its length", 0.0, nullptr},
    {FILM_FIELDS, "--shoulder-angle", "its angle", 0.0, nullptr},
    {FILM_FIELDS, "--lut-strength", "LUT's share", 0.0, nullptr},
    {FILM_FIELDS, "--spike-blades", nullptr, 0.0, "6"},
    {FILM_FIELDS, "--flare-ghosts", nullptr, 0.0, "5"},
    {QUALITY_FIELDS, "--samples-per-pixel", "samples", 0.0, nullptr},
    {QUALITY_FIELDS, "--max-disk-order", "disk images", 0.0, nullptr},
    {QUALITY_FIELDS, "--volume-resolution", "deep matter", 0.0, nullptr},
    {QUALITY_FIELDS, "--step", nullptr, 0.0, "default"},
    {QUALITY_FIELDS, "--tolerance", nullptr, 0.0, "default"},
};

// The structs of the lists, with the pages that explain them.
const struct {
    const Field *list;
    const char  *name, *page;
} STRUCTS[] = {
    {DISK_FIELDS, "BhrDisk", "docs/physics.md"},
    {VOLUME_FIELDS, "BhrVolume", "docs/matter.md"},
    {HOT_SPOT_FIELDS, "BhrHotSpot", "docs/matter.md"},
    {SKY_FIELDS, "BhrSky", "docs/maps.md"},
    {FILM_FIELDS, "BhrFilm", "docs/colour-and-film.md"},
    {QUALITY_FIELDS, "BhrQuality", "docs/quality.md"},
};

// The literature that these pages name.
const struct {
    const Field *list;
    const char  *option, *source;
} SOURCES[] = {
    {DISK_FIELDS, "--temperature", "the flux: Page and Thorne 1974; its colour: CIE 1931"},
    {FILM_FIELDS, "--tone-map",
     "ACES 1.0, fit of S. Hill 2015; AgX: T. Sobotka 2022; filmic: J. Hable 2017"},
    {FILM_FIELDS, "--bloom", "the eye's glare: Spencer et al., SIGGRAPH 1995"},
    {FILM_FIELDS, "--white-balance", "CIE 1931; Bradford's adaptation: K. M. Lam 1985"},
    {FILM_FIELDS, "--tint", "Duv: Y. Ohno, LEUKOS 10, 2014"},
    {FILM_FIELDS, "--saturation", "ASC CDL v1.2, 2009"},
    {FILM_FIELDS, "--toe-strength", "J. Hable 2017"},
    {FILM_FIELDS, "--toe-length", "J. Hable 2017"},
    {FILM_FIELDS, "--shoulder-strength", "J. Hable 2017"},
    {FILM_FIELDS, "--shoulder-length", "J. Hable 2017"},
    {FILM_FIELDS, "--shoulder-angle", "J. Hable 2017"},
    {FILM_FIELDS, "--highlights", "Durand and Dorsey, SIGGRAPH 2002; Chen, Paris and Durand, SIGGRAPH 2007"},
    {FILM_FIELDS, "--shadows", "Durand and Dorsey, SIGGRAPH 2002; Chen, Paris and Durand, SIGGRAPH 2007"},
    {FILM_FIELDS, "--spikes", "diffraction: J. Komrska, J. Opt. Soc. Am. 72, 1982"},
    {FILM_FIELDS, "--paper-white", "ITU-R BT.2408"},
    {FILM_FIELDS, "--peak", "ITU-R BT.2390, 5.4.1"},
    {FILM_FIELDS, "--lut-strength", "Cube LUT Specification 1.0, Adobe; tetrahedral: Kasson et al. 1995"},
    {QUALITY_FIELDS, "--method", "Nystrom 1925; Hairer, Norsett and Wanner"},
};

const auto *special(const Field *list, const Field &field) {
    const auto *found = std::find_if(std::begin(SPECIAL), std::end(SPECIAL), [&](const auto &row) {
        return row.list == list && std::strcmp(row.option, field.option) == 0;
    });
    return found == std::end(SPECIAL) ? nullptr : found;
}

bool has_unit(const Field &field, const char *unit) {
    return field.unit != nullptr && std::strcmp(field.unit, unit) == 0;
}

// A part of a value's range about its default: bhr.h's ranges are those of what can be traced, a million M and more.
void bound(FieldLook &look, const Field &field, double by_default) {
    look.low = field.low;
    look.high = field.high;
    const bool has_range = field.low < field.high;
    if (field.kind == OPTION_DEGREES) {
        look.low = has_range ? std::max(field.low / DEGREE, -180.0) : -180.0;
        look.high = has_range ? std::min(field.high / DEGREE, 180.0) : 180.0;
        return;
    }
    const bool fits = has_range && field.high - field.low <= LINEAR_SPAN;
    look.logarithmic = !fits || (field.low > 0.0 && field.high / field.low > LINEAR_RATIO);
    if (!fits && by_default > 0.0) {
        const double ratio = has_unit(field, "M") ? 20.0 : 1000.0;
        look.low = std::max(look.low, by_default / ratio);
        look.high = has_range ? std::min(look.high, by_default * ratio) : by_default * ratio;
    }
}

} // namespace

std::string as_label(const char *name) {
    std::string label = name;
    std::replace(label.begin(), label.end(), '-', ' ');
    return label;
}

std::string label_of(const Field *list, const Field &field) {
    const auto *row = special(list, field);
    return row != nullptr && row->label != nullptr ? row->label : as_label(FIELD_NAME(&field));
}

FieldLook look_of(const Field *list, const Field &field, double by_default, double value) {
    FieldLook look;
    look.label = label_of(list, field);
    look.unit = field.kind == OPTION_DEGREES ? DEGREE : 1.0;
    bound(look, field, by_default);
    const auto *row = special(list, field);
    if (row != nullptr && row->high > 0.0) {
        look.low = 0.0;
        look.high = row->high;
        look.logarithmic = row->high > LINEAR_SPAN;
    }
    if (row != nullptr && row->zero != nullptr && value == 0.0) {
        look.format = row->zero;
    } else if (field.kind == OPTION_DEGREES) {
        look.format = "%.1f\xC2\xB0";
    } else if (has_unit(field, "K")) {
        look.format = "%.0f K";
    } else if (has_unit(field, "EV")) {
        look.format = "%+.2f EV";
    } else if (look.logarithmic) {
        look.format = "%.4g";
    } else {
        look.format = look.high > 1.0 ? "%.2f" : "%.3f";
    }
    if (has_unit(field, "M") && look.format[0] == '%') {
        look.format += " M";
    }
    return look;
}

std::string tip_of(const Field *list, const Field &field) {
    const std::string about = field.about;
    std::string       tip = about;
    if (field.kind == OPTION_DEGREES) {
        tip += "\nunit: degrees; in bhr.h radians";
    } else if (field.unit != nullptr) {
        tip += std::string("\nunit: ") + field.unit;
    }
    if (field.range != nullptr && about.find(field.range) == std::string::npos) {
        tip += std::string("\nrange: ") + field.range;
    }
    for (const auto &row : STRUCTS) {
        if (row.list == list) {
            std::string name = FIELD_NAME(&field);
            std::replace(name.begin(), name.end(), '-', '_');
            tip += std::string("\n\n") + row.name + (field.kind == OPTION_BIT ? ".flags" : "." + name) + " in bhr.h; " +
                   row.page;
        }
    }
    for (const auto &row : SOURCES) {
        if (row.list == list && std::strcmp(row.option, field.option) == 0) {
            tip += std::string("\n") + row.source;
        }
    }
    return tip;
}
