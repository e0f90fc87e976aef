// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/control_overrides.h"

#include <algorithm>

namespace disparityd::capture {

namespace {

/// Returns the value of the last setting of this name, which is the one that the camera keeps.
std::optional<std::int64_t> value_in(const std::vector<CameraSetting>& settings, const std::string& name) {
    const auto found = std::find_if(settings.rbegin(), settings.rend(),
                                    [&name](const CameraSetting& setting) { return setting.name == name; });
    return found == settings.rend() ? std::nullopt : std::optional(found->value);
}

}  // namespace

void ControlOverrides::note(const std::vector<CameraSetting>& settings, const std::vector<CameraSetting>& configured) {
    const std::lock_guard lock(mutex_);
    for (const CameraSetting& setting : settings) {
        std::erase_if(noted_, [&setting](const Noted& old) { return old.setting.name == setting.name; });
        noted_.push_back({setting, value_in(configured, setting.name)});
    }
}

std::vector<CameraSetting> ControlOverrides::in_force(const std::vector<CameraSetting>& configured) {
    const std::lock_guard lock(mutex_);
    std::erase_if(noted_, [&configured](const Noted& old) {
        const auto now = value_in(configured, old.setting.name);
        return now && now != old.configured;
    });
    std::vector<CameraSetting> settings;
    for (const Noted& noted : noted_) {
        settings.push_back(noted.setting);
    }
    return settings;
}

}  // namespace disparityd::capture
