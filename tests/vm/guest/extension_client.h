// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/vm/camera/file_descriptor.h"

namespace vm_guest {

/// The camera's extension unit as the kernel passes it on, without any code of the daemon's.
class ExtensionClient {
public:
    using Bytes = std::vector<std::uint8_t>;

    explicit ExtensionClient(const std::string& node);

    std::size_t command_bytes() const;
    /// Sends a command, waits as long as the camera needs and fetches the answer.
    Bytes ask(Bytes command) const;

    /// One register of an eye's sensor (0xa3 left, 0xa5 right), such as 0x3509 for the low byte of its gain.
    std::uint8_t read_sensor(std::uint8_t eye, std::uint16_t address) const;
    void write_sensor(std::uint8_t eye, std::uint16_t address, std::uint8_t value) const;

    /// Lines of exposure, from its three registers.
    int exposure(std::uint8_t eye) const;

    static constexpr std::uint8_t left = 0xa3;
    static constexpr std::uint8_t right = 0xa5;

private:
    void query(std::uint8_t request, Bytes& data) const;

    simulated_camera::FileDescriptor device_;
};

}  // namespace vm_guest
