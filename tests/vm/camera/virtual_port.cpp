// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/virtual_port.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <sys/socket.h>

namespace simulated_camera {

namespace {

const std::string controller = "/sys/devices/platform/vhci_hcd.0";

// The kernel's enum usb_device_speed.
int speed_number(Link link) {
    return link == Link::usb3 ? 5 : 3;
}

// Lines of the status are: hub (hs or ss), port, state, and more; state 4 is a port without device.
int find_free_port(Link link) {
    std::ifstream status(controller + "/status");
    if (!status) {
        throw std::runtime_error(controller + "/status: not there; load the kernel module vhci-hcd");
    }
    const std::string wanted = link == Link::usb3 ? "ss" : "hs";
    std::string line;
    while (std::getline(status, line)) {
        std::istringstream words(line);
        std::string hub;
        int port = 0;
        int state = 0;
        if (words >> hub >> port >> state && hub == wanted && state == 4) {
            return port;
        }
    }
    throw std::runtime_error("no free " + wanted + " port of the virtual USB controller");
}

}  // namespace

FileDescriptor plug_into_virtual_port(Link link) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        throw std::runtime_error("no socket pair for a virtual USB port");
    }
    FileDescriptor device_end(ends[0]);
    const FileDescriptor host_end(ends[1]);
    constexpr int device_number = 1 << 16 | 2;  // bus 1, device 2; the kernel only shows it
    std::ofstream attach(controller + "/attach");
    attach << find_free_port(link) << ' ' << host_end.get() << ' ' << device_number << ' ' << speed_number(link)
           << std::flush;
    if (!attach) {
        throw std::runtime_error(controller + "/attach: the kernel refuses a device there");
    }
    return device_end;
}

}  // namespace simulated_camera
