// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/steady_timer.hpp>

#include "bridges/web/daemon/daemon_watch.h"
#include "bridges/web/http/served_daemon.h"

namespace disparityd::web {

/// Returns the name in a path "/i/NAME" or "/i/NAME/...", "" where it is none that a daemon can have.
std::string_view daemon_in_path(std::string_view path);

/// The daemons of this machine, each below /i/NAME/, and the page of all of them. They come and go: one that was seen
/// stays in the list, told to be gone, until the server ends. The network's thread owns it.
class AllDaemons : public ServedDaemons {
public:
    /// So many names are served at most; each may take four threads and, while somebody looks, a few frames.
    static constexpr std::size_t most = 32;

    /// Throws as base::start_thread() does.
    explicit AllDaemons(const ServerParts& parts);

    Destination destination(std::string_view path) override;
    void stop() override;

private:
    /// Answers what is asked about all.
    class Overview : public Handler {
    public:
        explicit Overview(AllDaemons& all) : all_(all) {}
        void view(const Asked& asked) override;
        std::string trouble() const override;
        std::string_view page() const override { return "/overview.html"; }

    private:
        std::string list_json() const;
        std::string note() const;

        AllDaemons& all_;
    };

    /// Answers for a daemon that was not seen yet: its page waits for it.
    class Absent : public Handler {
    public:
        void view(const Asked& asked) override;
        std::string trouble() const override;
        std::string_view page() const override { return "/index.html"; }
    };

    void on_names(const std::set<std::string>& names);
    void add_new();
    void try_again_later();

    ServerParts parts_;
    std::vector<std::string> folders_;
    std::map<std::string, std::unique_ptr<ServedDaemon>, std::less<>> daemons_;
    std::set<std::string> present_;                          ///< names that were seen at the last look
    std::set<std::string> beyond_;                           ///< names beyond the most
    std::map<std::string, std::set<std::string>> left_out_;  ///< names, by one line: what the system refused them
    boost::asio::steady_timer retry_;
    Overview overview_{*this};
    Absent absent_;
    DaemonWatch watch_;
};

}  // namespace disparityd::web
