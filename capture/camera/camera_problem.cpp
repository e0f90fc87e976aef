// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_problem.h"

#include <array>
#include <cerrno>
#include <cstdio>

#include "base/number_text.h"

namespace disparityd::capture {

namespace {

constexpr double usb3_mbit = 5000;

bool on_usb2(const UsbCamera& camera) {
    return camera.zed() != nullptr && camera.speed_mbit > 0 && camera.speed_mbit < usb3_mbit;
}

std::string hexadecimal(unsigned number, int digits) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%0*x", digits, number);
    return text.data();
}

}  // namespace

std::string firmware_text(std::uint16_t firmware) {
    return firmware == 0 ? "" : hexadecimal(firmware >> 8U, 1) + "." + hexadecimal(firmware & 0xffU, 2);
}

std::optional<CameraProblem> diagnose(const UsbCamera& camera, const CameraRequest& request) {
    if (camera.zed() != nullptr && camera.zed()->old_firmware) {
        return CameraProblem{CameraState::old_firmware,
                             camera.label() + " has an old firmware (USB id " + hexadecimal(camera.vendor, 4) + ":" +
                                 hexadecimal(camera.product, 4) +
                                 ") that gives no full video: update it with its maker's tool, then plug it in again"};
    }
    if (camera.node.empty()) {
        return CameraProblem{CameraState::failed, camera.label() +
                                                      " has no video device: load the driver (modprobe uvcvideo); the "
                                                      "kernel's log (dmesg) says more"};
    }
    if (on_usb2(camera) && !request.mode.empty() && request.mode != "vga") {
        return CameraProblem{CameraState::usb2_link,
                             camera.label() + " is on a USB 2 link (" + base::number_text(camera.speed_mbit) +
                                 " Mbit/s), which has no " + request.mode + ": use a USB 3 port and cable, or vga"};
    }
    return std::nullopt;
}

CameraProblem diagnose(const VideoError& error, const UsbCamera& camera, const std::string& label) {
    switch (error.code) {
        case EBUSY:
            return {CameraState::busy,
                    label + " is in use by another program: end that (fuser -v " + camera.node + " names it)"};
        case EACCES:
        case EPERM:
            return {CameraState::no_permission,
                    label +
                        " may not be opened by this user: add the user to the group video (usermod -aG video "
                        "USER) and install disparityd's udev rule; the device is " +
                        camera.node};
        case ENOENT:
        case ENODEV:
        case ENXIO: return {CameraState::absent, label + " went away while it was opened: check plug and cable"};
        case ENOSPC:
            return {CameraState::failed, label +
                                             " does not start: the USB has not enough bandwidth left; use another "
                                             "port, or a smaller mode or rate"};
        case EMFILE:
        case ENFILE:
        case ENOMEM: return {CameraState::failed, label + ": " + error.what()};  // the camera is not to blame
        default: break;
    }
    if (error.call == VideoError::Call::format) {
        std::string detail = error.what();
        detail += "; disparityctl sources shows the modes of each camera";
        if (on_usb2(camera)) {
            return {CameraState::usb2_link, detail + "; it is on a USB 2 link: use a USB 3 port and cable"};
        }
        return {CameraState::mode_refused, detail};
    }
    return {CameraState::failed, label + ": " + error.what() + "; plug it in again if this stays"};
}

CameraProblem absent_problem(const CameraRequest& request, const std::vector<UsbCamera>& present) {
    std::string detail = "no " + request.wanted() + ": plug it in";
    std::string list;
    for (const UsbCamera& camera : present) {
        list += (list.empty() ? "" : ", ") + camera.label();
    }
    return {CameraState::absent, detail + (list.empty() ? "" : " (there: " + list + ")")};
}

CameraProblem no_calibration_problem(const UsbCamera& camera, const std::vector<std::string>& folders) {
    std::string list;
    for (const std::string& folder : folders) {
        list += (list.empty() ? "" : " or ") + folder;
    }
    const std::string file = "SN" + (camera.serial.empty() ? "<serial>" : camera.serial) + ".conf";
    return {CameraState::no_calibration,
            "there is no calibration for " + camera.label() + ": " +
                (list.empty() ? "set [source] calibration_folders" : "put " + file + " into " + list) +
                ", name a file with [source] calibration, or allow pixels as captured with [source] "
                "allow_unrectified = true"};
}

std::vector<std::string> camera_notices(const UsbCamera& camera) {
    std::vector<std::string> notices;
    if (camera.autosuspend) {
        notices.push_back("the kernel may suspend " + camera.label() +
                          ": install disparityd's udev rule, or write \"on\" to /sys/bus/usb/devices/" + camera.port +
                          "/power/control");
    }
    if (on_usb2(camera)) {
        notices.push_back(camera.label() + " is on a USB 2 link, which has vga only");
    }
    return notices;
}

}  // namespace disparityd::capture
