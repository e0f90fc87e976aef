// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "pipeline/core_claims.h"

namespace disparityd::daemon {

/// Where the locks of cores lie: services and users of all kinds may write there, and containers that are to see the
/// frames of this computer have it, too.
inline constexpr const char* core_lock_folder = "/dev/shm";

/// Claims of cores among all processes on this computer that see the same folder: a file for each core,
/// disparityd-core-N, and who has locked it (flock) has the core. The system takes the lock from a process that ends,
/// however it ends. The files are empty, nobody may write to them, and they stay when it ends.
///
/// Others may remove them, as systemd does with those of a user who has logged out or of a service (RemoveIPC=), even
/// while another user has them locked. Whoever makes them anew can lock them, and two processes then have the same core
/// until claim() is called by the first one, which finds that its file has no name any more.
///
/// Daemons that take all cores they can get would not degrade evenly, were one of them pinned and the others not: while
/// two of them run, none of them has a core. Nor has one while a daemon runs that has a share of its own: who was given
/// a share is to find cores for it, whoever came first. Each daemon has a lock that excludes nobody on the file
/// disparityd-core-all or disparityd-core-shares, by which those that take all see it. They look when they claim: they
/// give way within the time between two claims.
///
/// Whoever may read the folder can lock a core, as whoever may run a program can pin a thread of it to any core: the
/// daemon is then not pinned there, which costs little.
class CoreLocks final : public pipeline::CoreClaims {
public:
    /// `takes_all`: whether this one takes all cores that it can get, not a share of its own.
    explicit CoreLocks(bool takes_all, std::string folder = core_lock_folder);
    /// Gives all cores back.
    ~CoreLocks() override;
    CoreLocks(const CoreLocks&) = delete;
    CoreLocks& operator=(const CoreLocks&) = delete;

    bool claim(int core) override;
    void leave() override;
    std::string refusal() const override { return refusal_; }

private:
    std::string path_of(int core) const;
    int open_file(const std::string& path);
    int lock_file(int core);
    std::string presence_path(bool takes_all) const;
    void tell_others();
    bool has_rivals();
    void give_back(int core);

    const bool takes_all_;
    const std::string folder_;
    int presence_ = -1;               ///< descriptor of the file by which others see this one
    std::map<int, int> descriptors_;  ///< of the files that are locked, by core
    std::string refusal_;
};

}  // namespace disparityd::daemon
