// SPDX-License-Identifier: Apache-2.0
//
// A stereo camera for tests, on the kernel's virtual USB controller. See usage().

#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <poll.h>
#include <sys/socket.h>

#include "tests/vm/camera/camera_model.h"
#include "tests/vm/camera/command_socket.h"
#include "tests/vm/camera/commands.h"
#include "tests/vm/camera/file_descriptor.h"

using namespace simulated_camera;

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

/// Plugs a device into a free port of the kernel's virtual USB controller (module vhci-hcd): gives back the device's
/// end of a connection that speaks USB/IP. Closing it unplugs. Throws std::runtime_error without such a controller or
/// port.
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

void usage() {
    std::printf(
        "usage: simulated_camera --socket PATH [--model MODEL] [--serial N] [--firmware BCD] [--usb2] [--isochronous]\n"
        "                        [--sensors] [--frames FILE | --jpeg FILE]\n"
        "       simulated_camera --socket PATH --tell COMMAND\n"
        "Plugs a camera into the virtual USB controller (module vhci-hcd) and serves it until it is ended.\n"
        "  --model    zed, zed-old, mini, mini-old, zed2, zed2i\n"
        "  --frames   raw YUYV frames of the mode in use, repeated; without: a numbered pattern\n"
        "  --jpeg     offers MJPEG in place of YUYV; each frame is this file\n"
        "  --sensors  plugs in the sensors of a mini, zed2 or zed2i as well\n"
        "  --tell     gives a command to a running one: %s\n"
        "example: simulated_camera --socket /run/camera --tell 'err 3'\n",
        commands_help);
}

struct Arguments {
    CameraOptions camera;
    std::string socket;
    std::string command;
};

class UsageError : public std::invalid_argument {
    using std::invalid_argument::invalid_argument;
};

void take_value(Arguments& arguments, const std::string& option, const std::string& value) {
    if (option == "--socket") {
        arguments.socket = value;
    } else if (option == "--tell") {
        arguments.command = value;
    } else if (option == "--frames") {
        arguments.camera.frames_file = value;
    } else if (option == "--jpeg") {
        arguments.camera.frames_file = value;
        arguments.camera.jpeg = true;
    } else if (option == "--serial") {
        arguments.camera.serial = static_cast<std::uint32_t>(std::stoul(value));
    } else if (option == "--firmware") {
        arguments.camera.firmware = static_cast<std::uint16_t>(std::stoul(value, nullptr, 16));
    } else if (option == "--model" && find_model(value) != nullptr) {
        arguments.camera.model = find_model(value);
    } else {
        throw UsageError("found " + option + " " + value + "; see --help");
    }
}

Arguments read_arguments(int argc, char** argv) {
    Arguments arguments;
    for (int i = 1; i < argc; ++i) {
        const std::string option = argv[i];
        if (option == "--help") {
            usage();
            std::exit(0);
        } else if (option == "--usb2") {
            arguments.camera.link = Link::usb2;
        } else if (option == "--sensors") {
            arguments.camera.sensors = true;
        } else if (option == "--isochronous") {
            arguments.camera.transfer = Transfer::isochronous;
        } else if (i + 1 < argc) {
            take_value(arguments, option, argv[++i]);
        } else {
            throw UsageError("found " + option + "; see --help");
        }
    }
    if (arguments.socket.empty()) {
        throw UsageError("--socket is missing; see --help");
    }
    return arguments;
}

[[noreturn]] void serve(const Arguments& arguments) {
    Camera camera(arguments.camera, plug_into_virtual_port);
    CommandSocket commands(arguments.socket);
    camera.plug_in();
    while (true) {
        auto& sensors = camera.sensors();
        std::array<pollfd, 5> waiting{{{commands.listener(), POLLIN, 0},
                                       {camera.timer(), POLLIN, 0},
                                       {camera.host_socket(), POLLIN, 0},
                                       {sensors ? sensors->timer() : -1, POLLIN, 0},
                                       {sensors ? sensors->socket() : -1, POLLIN, 0}}};
        if (::poll(waiting.data(), waiting.size(), -1) < 0) {
            continue;
        }
        if (waiting[4].revents != 0 && !sensors->handle_message()) {
            sensors.reset();
        } else if (waiting[3].revents != 0) {
            sensors->handle_timer();
        }
        // The host first: a command may end its connection.
        if (waiting[2].revents != 0) {
            camera.handle_host();
        }
        if (waiting[1].revents != 0) {
            camera.handle_timer();
        }
        if (waiting[0].revents != 0) {
            commands.serve([&](const std::string& line) { return carry_out(camera, line); });
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const Arguments arguments = read_arguments(argc, argv);
        if (arguments.command.empty()) {
            serve(arguments);
        }
        const std::string answer = send_command(arguments.socket, arguments.command);
        std::puts(answer.c_str());
        return answer.starts_with("error") ? 1 : 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "simulated_camera: error: %s\n", error.what());
        return 2;
    }
}
