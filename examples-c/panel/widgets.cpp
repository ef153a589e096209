// SPDX-License-Identifier: MIT OR Apache-2.0
// widgets.cpp -- see widgets.h.
#include "widgets.h"

#include "draw.h"
#include "field_look.h"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

constexpr double TIP_SECONDS = 0.4; // that the mouse rests before a tip comes

} // namespace

void tell(const std::string &tip) {
    static ImVec2 rested_on(-1.0F, -1.0F); // the last item that the mouse was on, by its place, and since when
    static double since = 0.0;
    // A tip over a slider that is dragged would hide what the hand looks at.
    if (tip.empty() || ImGui::IsItemActive() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
        return;
    }
    const ImVec2 place = ImGui::GetItemRectMin();
    if (place.x != rested_on.x || place.y != rested_on.y || ImGui::IsAnyMouseDown()) {
        rested_on = place;
        since = ImGui::GetTime();
    }
    if (ImGui::GetTime() - since < TIP_SECONDS) {
        return;
    }
    ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 1.0F); // of a widget that is grey, too
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(32.0F * ImGui::GetFontSize());
    ImGui::TextUnformatted(tip.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar();
}

void fact(const char *name, double value, const char *format, bool left) {
    if (!left) {
        ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
    }
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(colour::dim), "%s", name);
    ImGui::SameLine(0.0F, 0.4F * ImGui::GetFontSize());
    if (std::isnan(value)) {
        ImGui::TextUnformatted("-");
    } else {
        ImGui::Text(format, value);
    }
}

void Widgets::report(const char *section, const char *widget, const std::string &message) {
    const std::string key = std::string(section) + "/" + widget;
    if (message.empty()) {
        messages_.erase(key);
        refused_.erase(key);
    } else if (messages_[key] != message) {
        messages_[key] = last_refusal_ = message;
        refusals_++;
    }
}

void Widgets::show_message(const char *label) {
    const auto found = messages_.find(std::string(section_) + "/" + label);
    if (found == messages_.end()) {
        return;
    }
    ImGui::PushStyleColor(ImGuiCol_Text, colour::error);
    ImGui::TextWrapped("%s", found->second.c_str());
    ImGui::PopStyleColor();
}

bool Widgets::section(const char *name, bool open) {
    section_ = name;
    return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None);
}

void Widgets::mark(const char *label) {
    if (ImGui::IsItemVisible()) {
        const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
        places_[std::string(section_) + "/" + label] = {std::floor(0.5F * (low.x + high.x)),
                                                        std::floor(0.5F * (low.y + high.y))};
    }
}

// The label; the widget goes on beside it with the rest of the line.
void Widgets::begin_row(const char *label, const std::string &tip) {
    ImGui::PushID(label);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(label, std::strstr(label, "##"));
    tell(tip);
    ImGui::SameLine(LABEL_EMS * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(-1.0F);
}

// Behind the widget.
void Widgets::end_row(const char *label, const std::string &tip) {
    mark(label);
    tell(tip);
    ImGui::PopID();
    show_message(label);
}

// ImGui offers a number that is being typed anew with every frame, as long as it is not the one in force: what was
// refused is not asked for again.
void Widgets::try_number(const char *label, double value, const std::function<Result()> &set) {
    const std::string key = std::string(section_) + "/" + label;
    if (const auto found = refused_.find(key); found != refused_.end() && found->second == value) {
        return;
    }
    const Result result = set();
    report(section_, label, result.message);
    if (!result.ok()) {
        refused_[key] = value;
    }
}

void Widgets::number(const char *label, double value, double low, double high, const char *format, bool logarithmic,
                     const Set<double> &set, const std::string &tip) {
    begin_row(label, tip);
    const ImGuiSliderFlags flags = logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (ImGui::SliderScalar("##value", ImGuiDataType_Double, &value, &low, &high, format, flags)) {
        try_number(label, value, [&] { return set(value); });
    }
    end_row(label, tip);
}

void Widgets::whole(const char *label, uint32_t value, uint32_t low, uint32_t high, const Set<uint32_t> &set,
                    const std::string &tip, const char *format) {
    begin_row(label, tip);
    const ImGuiSliderFlags flags = high > 100 ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None;
    if (ImGui::SliderScalar("##value", ImGuiDataType_U32, &value, &low, &high, format, flags)) {
        try_number(label, value, [&] { return set(value); });
    }
    end_row(label, tip);
}

void Widgets::vector(const char *label, const double value[3], const Set<const double *> &set,
                     const std::string &tip) {
    double edited[3] = {value[0], value[1], value[2]};
    begin_row(label, tip);
    if (ImGui::DragScalarN("##value", ImGuiDataType_Double, edited, 3, 0.005F, nullptr, nullptr, "%.3f")) {
        report(section_, label, set(edited).message);
    }
    end_row(label, tip);
}

void Widgets::choice(const char *label, int32_t value, const Choice *choices, const Set<int32_t> &set,
                     const std::string &tip) {
    const Choice *chosen = choices;
    while (chosen->name != nullptr && chosen->value != value) {
        chosen++;
    }
    begin_row(label, tip);
    if (ImGui::BeginCombo("##value", chosen->name != nullptr ? as_label(chosen->name).c_str() : "")) {
        for (; choices->name != nullptr; choices++) {
            if (ImGui::Selectable(as_label(choices->name).c_str(), choices->value == value)) {
                report(section_, label, set(choices->value).message);
            }
        }
        ImGui::EndCombo();
    }
    end_row(label, tip);
}

void Widgets::flag(const char *label, uint32_t flags, uint32_t bit, const Set<uint32_t> &set, const std::string &tip) {
    if (ImGui::CheckboxFlags(label, &flags, bit)) {
        report(section_, label, set(flags).message);
    }
    mark(label);
    tell(tip);
}

// A check box for each bit, three in a row.
void Widgets::bits(uint32_t flags, const Choice *choices, const Set<uint32_t> &set, const std::string &tip) {
    for (const Choice *part = choices; part->name != nullptr; part++) {
        const auto column = (part - choices) % 3;
        if (column != 0) {
            ImGui::SameLine(static_cast<float>(column) * LABEL_EMS * ImGui::GetFontSize());
        }
        flag(as_label(part->name).c_str(), flags, static_cast<uint32_t>(part->value), set, tip);
    }
    for (const Choice *part = choices; part->name != nullptr; part++) {
        show_message(as_label(part->name).c_str());
    }
}

void Widgets::seed(const char *label, uint64_t value, const Set<uint64_t> &set, const std::string &tip) {
    begin_row(label, tip);
    constexpr uint64_t one = 1;
    if (ImGui::InputScalar("##value", ImGuiDataType_U64, &value, &one)) {
        report(section_, label, set(value).message);
    }
    end_row(label, tip);
}

void Widgets::text(const char *label, const std::string &value, const Set<const char *> &set, const std::string &tip) {
    const std::string key = std::string(section_) + "/" + label;
    char              shown[sizeof edited_];
    char             *buffer = edited_of_ == key ? edited_ : shown;
    if (buffer == shown) {
        std::snprintf(shown, sizeof shown, "%s", value.c_str());
    }
    begin_row(label, tip);
    const bool entered = ImGui::InputText("##value", buffer, sizeof edited_, ImGuiInputTextFlags_EnterReturnsTrue);
    if (ImGui::IsItemActivated() && buffer == shown) {
        std::memcpy(edited_, shown, sizeof edited_);
        edited_of_ = key;
    }
    if (entered) {
        report(section_, label, set(buffer).message);
    }
    if (entered || ImGui::IsItemDeactivated()) {
        edited_of_.clear();
    }
    end_row(label, tip);
}

void Widgets::fields(const Field *list, void *value, const void *defaults, const std::function<Result()> &set,
                     const Shown &shown) {
    for (const Field *field = list; field->option != nullptr; field++) {
        if (shown(*field)) {
            this->field(list, *field, static_cast<char *>(value) + field->offset,
                        static_cast<const char *>(defaults) + field->offset, set);
        }
    }
}

// Assigns, and asks for the struct that has the new value.
void Widgets::field(const Field *list, const Field &field, char *target, const char *by_default,
                    const std::function<Result()> &set) {
    const std::string label = label_of(list, field), tip = tip_of(list, field);
    const auto        assign = [&](auto value) {
        *reinterpret_cast<decltype(value) *>(target) = value;
        return set();
    };
    switch (field.kind) {
    case OPTION_BIT: {
        // Two in a row; the bits of a struct come first.
        if ((&field - list) % 2 == 1) {
            ImGui::SameLine(0.5F * ImGui::GetWindowContentRegionMax().x);
        }
        flag(label.c_str(), *reinterpret_cast<const uint32_t *>(target), static_cast<uint32_t>(field.choices->value),
             assign, tip);
        for (const Field *bit = list; (&field)[1].kind != OPTION_BIT && bit <= &field; bit++) {
            show_message(label_of(list, *bit).c_str()); // below the last of them
        }
        break;
    }
    case OPTION_BITS:
        bits(*reinterpret_cast<const uint32_t *>(target), field.choices, assign, tip);
        break;
    case OPTION_CHOICE:
        choice(label.c_str(), *reinterpret_cast<const int32_t *>(target), field.choices, assign, tip);
        break;
    case OPTION_UINT: {
        const uint32_t    now = *reinterpret_cast<const uint32_t *>(target);
        const std::string word = look_of(list, field, 0.0, now).format; // of what 0 stands for
        whole(label.c_str(), now, static_cast<uint32_t>(field.low), static_cast<uint32_t>(field.high), assign, tip,
              now == 0 && word[0] != '%' ? word.c_str() : "%u");
        break;
    }
    case OPTION_UINT64:
        seed(label.c_str(), *reinterpret_cast<const uint64_t *>(target), assign, tip);
        break;
    case OPTION_VECTOR:
        vector(label.c_str(), reinterpret_cast<const double *>(target), [&](const double *edited) {
            std::copy(edited, edited + 3, reinterpret_cast<double *>(target));
            return set();
        }, tip);
        break;
    case OPTION_DOUBLE:
    case OPTION_DEGREES: {
        const double    now = *reinterpret_cast<const double *>(target);
        const FieldLook look = look_of(list, field, *reinterpret_cast<const double *>(by_default), now);
        number(look.label.c_str(), now / look.unit, look.low, look.high, look.format.c_str(), look.logarithmic,
               [&](double shown) { return assign(shown * look.unit); }, tip);
        break;
    }
    default:
        break; // pairs and fours have no widget
    }
}
