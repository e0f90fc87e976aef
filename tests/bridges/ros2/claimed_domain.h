// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparityd::test {

/// Two domains of DDS that no other test of this machine uses at the same time.
class ClaimedDomain {
public:
    /// Throws std::runtime_error when others have them all.
    ClaimedDomain();
    ~ClaimedDomain();
    ClaimedDomain(const ClaimedDomain&) = delete;
    ClaimedDomain& operator=(const ClaimedDomain&) = delete;

    std::uint32_t id() const { return id_; }
    std::uint32_t other() const { return id_ + 60; }

private:
    int fd_ = -1;  ///< holds a lock, which ends with the process at the latest
    std::uint32_t id_ = 0;
};

}  // namespace disparityd::test
