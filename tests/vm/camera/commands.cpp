// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/commands.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace simulated_camera {

namespace {

bool plug(Camera& camera, std::istream& words) {
    std::string name;
    if (words >> name) {
        const Model* model = find_model(name);
        std::uint32_t serial = 0;
        if (model == nullptr || !(words >> serial)) {
            return false;
        }
        camera.become(*model, serial);
    }
    camera.plug_in();
    return true;
}

bool freeze(Camera& camera, std::istream& words) {
    std::string until;
    words >> until;
    if (until.empty()) {
        camera.faults().frozen = FrozenUntil::thaw;
    } else if (until == "restart") {
        camera.faults().frozen = FrozenUntil::stream_restart;
    } else if (until == "reset") {
        camera.faults().frozen = FrozenUntil::usb_reset;
    } else {
        return false;
    }
    return true;
}

bool count(Camera& camera, const std::string& fault, std::istream& words) {
    int times = 0;
    if (!(words >> times)) {
        return false;
    }
    Faults& faults = camera.faults();
    if (fault == "err") {
        faults.frames_with_error = times;
    } else if (fault == "short") {
        faults.frames_short = times;
    } else if (fault == "drop") {
        faults.frames_dropped = times;
    } else if (fault == "stall") {
        faults.transfers_stalled = times;
    } else {
        return false;
    }
    return true;
}

bool carry_out(Camera& camera, const std::string& command, std::istream& words) {
    if (command == "unplug") {
        camera.unplug();
        return true;
    }
    if (command == "thaw") {
        camera.thaw();
        return true;
    }
    if (command == "plug") {
        return plug(camera, words);
    }
    return command == "freeze" ? freeze(camera, words) : count(camera, command, words);
}

}  // namespace

const Model* find_model(const std::string& name) {
    const auto found = std::find_if(models.begin(), models.end(), [&](const Model& each) { return each.name == name; });
    return found == models.end() ? nullptr : &*found;
}

std::string carry_out(Camera& camera, const std::string& line) {
    std::istringstream words(line);
    std::string command;
    words >> command;
    if (command == "status") {
        return camera.describe();
    }
    try {
        return carry_out(camera, command, words) ? "ok" : "error: found '" + line + "', allowed: " + commands_help;
    } catch (const std::runtime_error& error) {
        return std::string("error: ") + error.what();
    }
}

}  // namespace simulated_camera
