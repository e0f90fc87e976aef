// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_watch.h"

#include <cerrno>
#include <filesystem>
#include <optional>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "base/start_thread.h"
#include "proto/shared_memory_layout.h"
#include "proto/socket_places.h"

namespace disparityd::web {
namespace {

using std::chrono::system_clock;

constexpr std::chrono::seconds interval{1};
/// A folder's time has steps: of two changes within one, the second leaves it as it is.
constexpr std::chrono::seconds longest_step{2};
constexpr const char* shared_memory = "/dev/shm";

/// Returns the time of a folder's last change; the epoch where there is none.
system_clock::time_point change_of(const std::string& folder) {
    struct stat status {};
    if (stat(folder.c_str(), &status) != 0) {
        return {};
    }
    return system_clock::time_point(std::chrono::duration_cast<system_clock::duration>(
        std::chrono::seconds(status.st_mtim.tv_sec) + std::chrono::nanoseconds(status.st_mtim.tv_nsec)));
}

/// Browsers take these two for folders: such a daemon has no address here.
bool fits_into_address(const std::string& name) {
    return name != "." && name != "..";
}

template <typename Take>
void for_each_file(const std::string& folder, const Take& take) {
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        take(entry->path().filename().string());
    }
}

std::string list_of(const std::vector<std::string>& words) {
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        list += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    }
    return list;
}

/// Returns the names of daemons that have, or had, shared memory on this machine.
std::vector<std::string> names_in_shared_memory() {
    std::vector<std::string> names;
    for_each_file(shared_memory, [&](const std::string& file) {
        if (const std::optional<std::string> name = proto::daemon_of_shm_file(file)) {
            names.push_back(*name);
        }
    });
    return names;
}

}  // namespace

/// Reads a folder where it has changed. Returns whether its names are others now.
bool SocketScan::refresh(const std::string& folder, bool of_the_system) {
    Known& known = known_[folder];
    const Clock::time_point changed = change_of(folder);
    if (known.settled && known.changed == changed) {
        return false;
    }
    known.changed = changed;
    known.settled = Clock::now() - changed > longest_step;
    std::set<std::string> names;
    for_each_file(folder, [&](const std::string& file) {
        const std::optional<std::string> name = proto::daemon_of_socket_file(file, folder);
        if (name && is_daemon(*name, folder + '/' + file, of_the_system)) {
            names.insert(*name);
        }
    });
    return std::exchange(known.names, names) != names;
}

bool SocketScan::is_daemon(const std::string& name, const std::string& path, bool of_the_system) {
    if (!fits_into_address(name) || !proto::is_trusted_socket(path, of_the_system) ||
        (seen_.count(name) == 0 && proto::nobody_listens(path))) {
        return false;
    }
    seen_.insert(name);
    return true;
}

const std::set<std::string>& SocketScan::names() {
    bool others = false;
    for (std::size_t i = 0; i < folders_.size(); ++i) {
        others = refresh(folders_[i], i == 0) || others;
    }
    if (others) {
        all_.clear();
        for (const auto& [folder, known] : known_) {
            all_.insert(known.names.begin(), known.names.end());
        }
    }
    return all_;
}

std::string why_no_daemon(const std::vector<std::string>& folders) {
    const std::string line = "no daemon has a socket in " + list_of(folders);
    for (const std::string& folder : folders) {
        if (access(folder.c_str(), R_OK | X_OK) != 0 && errno == EACCES) {
            return line + ": this user may not read " + folder + "; run disparity-web as a user who may";
        }
    }
    const std::vector<std::string> others = names_in_shared_memory();
    if (others.empty()) {
        return line + ": start one, with systemctl start disparityd@NAME or disparityd --name NAME";
    }
    return line + ", but there is shared memory of " + others.front() +
           (others.size() > 1 ? " and " + std::to_string(others.size() - 1) + " more" : "") +
           ": that daemon has its socket elsewhere (set [socket] unix = \"auto\"), belongs to another user (run "
           "disparity-web as that user, or as the service does), or was killed";
}

DaemonWatch::DaemonWatch(std::vector<std::string> folders, std::function<void(std::set<std::string>)> on_names)
    : scan_(std::move(folders)), on_names_(std::move(on_names)), thread_(base::start_thread([this] { run(); })) {}

DaemonWatch::~DaemonWatch() {
    stop();
    thread_.join();
}

void DaemonWatch::stop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
}

void DaemonWatch::run() {
    std::optional<std::set<std::string>> told;
    for (;;) {
        if (const std::set<std::string>& names = scan_.names(); told != names) {
            told = names;
            on_names_(names);
        }
        std::unique_lock lock(mutex_);
        if (changed_.wait_for(lock, interval, [this] { return stop_; })) {
            return;
        }
    }
}

}  // namespace disparityd::web
