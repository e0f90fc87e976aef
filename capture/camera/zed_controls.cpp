// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/zed_controls.h"

#include <array>
#include <stdexcept>
#include <utility>

namespace disparityd::capture {

namespace {

constexpr const char* automatic = "auto-exposure";
constexpr std::uint8_t automatic_bit = 1U << 1U;
constexpr std::array<std::uint32_t, 2> automatic_registers{0x80181033, 0x80181833};  // left, right

constexpr std::uint32_t exposure_register = 0x3500;  // high, middle, low byte of sixteenths of a line
constexpr std::uint32_t gain_register = 0x3507;      // high, middle, low byte
constexpr int shortest_exposure = 2;
constexpr std::array<std::pair<int, int>, 4> gain_zones{{{0, 255}, {378, 511}, {890, 1023}, {1914, 2047}}};

constexpr std::array<std::pair<const char*, ZedPart>, 2> eyes{
    {{"left", ZedPart::left_sensor}, {"right", ZedPart::right_sensor}}};

std::uint32_t read_three(ZedUnit& unit, ZedPart eye, std::uint32_t address) {
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        value = (value << 8U) | unit.read(eye, address + i);
    }
    return value;
}

void write_three(ZedUnit& unit, ZedPart eye, std::uint32_t address, std::uint32_t value) {
    for (std::uint32_t i = 0; i < 3; ++i) {
        unit.write(eye, address + i, static_cast<std::uint8_t>(value >> (8U * (2 - i))));
    }
}

void refuse(const CameraSetting& setting, const std::string& allowed) {
    throw std::invalid_argument("camera: " + setting.name + ": found " + std::to_string(setting.value) +
                                ", allowed: " + allowed);
}

void set_automatic(ZedUnit& unit, bool on) {
    for (const std::uint32_t address : automatic_registers) {
        const std::uint8_t before = unit.read(ZedPart::processor, address);
        const auto off = static_cast<std::uint8_t>(before & ~automatic_bit);
        unit.write(ZedPart::processor, address, static_cast<std::uint8_t>(off | (on ? automatic_bit : 0U)));
    }
}

}  // namespace

int longest_exposure(double rate) {
    return rate <= 15 ? 1550 : rate <= 30 ? 1100 : rate <= 60 ? 880 : 720;
}

bool is_zed_gain(std::int64_t gain) {
    for (const auto& [least, most] : gain_zones) {
        if (gain >= least && gain <= most) {
            return true;
        }
    }
    return false;
}

std::vector<CameraControl> read_zed_controls(ZedUnit& unit, double rate) {
    bool on = true;
    for (const std::uint32_t address : automatic_registers) {
        on = on && (unit.read(ZedPart::processor, address) & automatic_bit) != 0;
    }
    std::vector<CameraControl> list{{automatic, on ? 1 : 0, 0, 1, 1}};
    for (const auto& [name, eye] : eyes) {
        const std::int64_t lines = read_three(unit, eye, exposure_register) >> 4U;
        list.push_back({std::string("exposure-") + name, lines, shortest_exposure, longest_exposure(rate), 0});
    }
    for (const auto& [name, eye] : eyes) {
        const std::int64_t gain = read_three(unit, eye, gain_register);
        list.push_back({std::string("gain-") + name, gain, gain_zones.front().first, gain_zones.back().second, 0});
    }
    return list;
}

bool is_zed_control(const CameraSetting& setting, double rate) {
    if (setting.name == automatic) {
        if (setting.value != 0 && setting.value != 1) {
            refuse(setting, "0 or 1");
        }
        return true;
    }
    if (setting.name == "exposure-left" || setting.name == "exposure-right") {
        if (setting.value < shortest_exposure || setting.value > longest_exposure(rate)) {
            refuse(setting, std::to_string(shortest_exposure) + " .. " + std::to_string(longest_exposure(rate)) +
                                " lines at this frame rate");
        }
        return true;
    }
    if (setting.name == "gain-left" || setting.name == "gain-right") {
        if (!is_zed_gain(setting.value)) {
            refuse(setting, "0 .. 255, 378 .. 511, 890 .. 1023 or 1914 .. 2047");
        }
        return true;
    }
    return false;
}

void set_zed_control(ZedUnit& unit, const CameraSetting& setting) {
    if (setting.name == automatic) {
        set_automatic(unit, setting.value != 0);
        return;
    }
    const ZedPart eye = setting.name.ends_with("left") ? ZedPart::left_sensor : ZedPart::right_sensor;
    const auto value = static_cast<std::uint32_t>(setting.value);
    if (setting.name.starts_with("exposure")) {
        write_three(unit, eye, exposure_register, value << 4U);
    } else {
        write_three(unit, eye, gain_register, value);
    }
}

}  // namespace disparityd::capture
