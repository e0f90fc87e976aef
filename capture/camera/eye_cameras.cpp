// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/eye_cameras.h"

#include <algorithm>
#include <utility>

namespace disparityd::capture {
namespace {

Eye other(Eye eye) {
    return eye == Eye::left ? Eye::right : Eye::left;
}

std::string name_of(Eye eye) {
    return eye == Eye::left ? "left" : "right";
}

const std::string& place_of(const UsbCamera& camera) {
    return camera.place.empty() ? camera.port : camera.place;
}

/// Tells how much `camera` is like the one that was known, and not like the one that the other eye had: 0 it is not
/// that one, 1 it is at its place, 2 it has its serial number, 3 both.
int likeness(const UsbCamera& camera, const UsbCamera& known, const std::optional<UsbCamera>& of_other_eye) {
    const bool serial_tells = !known.serial.empty() && (!of_other_eye || of_other_eye->serial != known.serial);
    const bool same_serial = serial_tells && camera.serial == known.serial;
    const std::string& place = place_of(known);
    const bool place_tells = !place.empty() && (!of_other_eye || place_of(*of_other_eye) != place);
    const bool others_serial = of_other_eye && !camera.serial.empty() && camera.serial == of_other_eye->serial &&
                               camera.serial != known.serial;
    const bool same_place = place_tells && place_of(camera) == place && !others_serial;
    return (same_serial ? 2 : 0) + (same_place ? 1 : 0);
}

bool is_known(const UsbCamera& camera, const UsbCamera& known, const std::optional<UsbCamera>& of_other_eye) {
    return likeness(camera, known, of_other_eye) > 0;
}

/// Returns the camera that is most like the known one, or null. What the other eye has now is none.
const UsbCamera* likeliest(const std::vector<UsbCamera>& cameras, const UsbCamera& known,
                           const std::optional<UsbCamera>& of_other_eye, bool other_is_there) {
    const UsbCamera* best = nullptr;
    int most = 0;
    for (const UsbCamera& camera : cameras) {
        const int like = likeness(camera, known, of_other_eye);
        if (like > most && !(other_is_there && same_plugging(camera, *of_other_eye))) {
            most = like;
            best = &camera;
        }
    }
    return best;
}

/// Whether `camera` may be the one that `other_eye` had, while that one is away and this eye never had any: without two
/// serial numbers that differ, it may be that one at another place.
bool may_be_known(const UsbCamera& camera, const UsbCamera& other_eye) {
    return camera.serial.empty() || other_eye.serial.empty() || is_known(camera, other_eye, std::nullopt);
}

/// A name by the place means whatever is plugged in there.
bool names_a_node(const CameraRequest& request) {
    return !request.device.empty() && !request.device.starts_with("/dev/v4l/by-path/");
}

}  // namespace

EyeCameras::EyeCameras(const CameraRequest& pair)
    : eyes_{{{request_of_eye(pair, Eye::left), {}}, {request_of_eye(pair, Eye::right), {}}}} {}

bool EyeCameras::is_held(const Known& known, const std::vector<UsbCamera>& present) {
    return known.held && std::any_of(present.begin(), present.end(),
                                     [&](const UsbCamera& camera) { return same_plugging(camera, *known.camera); });
}

EyeCameras::Choice EyeCameras::choose(Eye eye, const std::vector<UsbCamera>& present) const {
    const Known& own = of(eye);
    const Known& partner = of(other(eye));
    Choice choice;
    std::vector<UsbCamera> named;
    for (UsbCamera& camera : candidates(present, own.request)) {
        if (!is_held(partner, present) || !same_plugging(camera, *partner.camera)) {
            named.push_back(std::move(camera));
        } else if (own.request.serial.empty() || own.request.serial == camera.serial) {
            choice.problem = {CameraState::failed, one_camera_text(camera)};
        }
    }
    if (own.camera && names_a_node(own.request)) {
        return choose_again(eye, present, std::move(named));
    }
    const bool partner_away = partner.camera && !is_held(partner, present) && names_a_node(own.request);
    if (partner_away && std::erase_if(named, [&](const UsbCamera& c) { return may_be_known(c, *partner.camera); })) {
        choice.problem = {CameraState::failed, "the " + name_of(eye) + " eye waits for the camera of the " +
                                                   name_of(other(eye)) + " one, " + partner.camera->label() +
                                                   ": what is at " + own.request.device +
                                                   " may be that one; plug it in where it was"};
    }
    choice.problem = named.empty() ? choice.problem : std::nullopt;
    choice.cameras = std::move(named);
    return choice;
}

/// For an eye that had a camera. `named`: those at the node that is named, but for the one that the other eye holds.
EyeCameras::Choice EyeCameras::choose_again(Eye eye, const std::vector<UsbCamera>& present,
                                            std::vector<UsbCamera> named) const {
    const Known& own = of(eye);
    const Known& partner = of(other(eye));
    const bool partner_there = is_held(partner, present);
    if (const UsbCamera* known = likeliest(present, *own.camera, partner.camera, partner_there)) {
        return {{*known}, {}};
    }
    std::erase_if(named, [&](const UsbCamera& camera) {
        return partner.camera && is_known(camera, *partner.camera, own.camera);
    });
    if (named.empty()) {
        return {{},
                {{CameraState::absent, "the camera of the " + name_of(eye) + " eye is not there, " +
                                           own.camera->label() + ": plug it in where it was"}}};
    }
    if (partner_there) {
        return {std::move(named), {}};
    }
    if (!partner.camera) {
        return {{},
                {{CameraState::failed, "the " + name_of(eye) + " eye had " + own.camera->label() + ", and " +
                                           named.front().label() +
                                           " may be the other eye's: plug the eye's own in where it was, or look which "
                                           "eye is which and start the daemon anew"}}};
    }
    if (eye == Eye::right && choose(Eye::left, present).problem) {
        return {{}, {{CameraState::failed, "the right eye waits for the left one"}}};
    }
    return {{},
            {{CameraState::failed,
              "the eyes cannot be told apart: both cameras were gone at once, and " + named.front().label() +
                  " has neither the serial number nor the USB port that one of them had; plug both in "
                  "where they were, or look which eye is which and start the daemon anew"}}};
}

std::optional<UsbCamera> EyeCameras::likely(Eye eye, const std::vector<UsbCamera>& present) const {
    const CameraRequest& request = of(eye).request;
    for (const UsbCamera& camera : candidates(present, request)) {
        if (request.serial.empty() || camera.serial == request.serial) {
            return camera;
        }
    }
    return std::nullopt;
}

std::string EyeCameras::one_camera_text(const UsbCamera& camera) {
    return "left and right: both are " + camera.label() +
           ", allowed are two cameras; those on one USB port are told apart by node";
}

void EyeCameras::opened(Eye eye, const UsbCamera& camera) {
    Known& known = eyes_[static_cast<std::size_t>(eye)];
    known.camera = camera;
    known.held = true;
}

void EyeCameras::unplugged(Eye eye) {
    eyes_[static_cast<std::size_t>(eye)].held = false;
}

}  // namespace disparityd::capture
