// SPDX-License-Identifier: Apache-2.0
#include "daemon/system/huge_pages.h"

#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <sys/prctl.h>

namespace disparityd::daemon {
namespace {

constexpr const char* policy_file = "/sys/kernel/mm/transparent_hugepage/enabled";

std::string text_of(const char* path) {
    const std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::size_t megabytes(std::size_t bytes) {
    return (bytes + 500'000) / 1'000'000;
}

}  // namespace

std::string chosen_word(const std::string& text) {
    const std::size_t first = text.find('[');
    const std::size_t last = text.find(']');
    return first == std::string::npos || last == std::string::npos || last < first
               ? std::string()
               : text.substr(first + 1, last - first - 1);
}

void count_huge_pages(const std::string& smaps, HugePages& pages) {
    constexpr std::size_t kilobyte = 1024;
    std::istringstream lines(smaps);
    std::size_t resident = 0, huge = 0;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string key;
        words >> key;
        if (key == "Rss:") {
            words >> resident;
        } else if (key == "AnonHugePages:") {
            words >> huge;
        } else if (key == "VmFlags:" && (line + ' ').find(" hg ") != std::string::npos) {
            // VmFlags is the last line of a mapping; madvise(MADV_HUGEPAGE) sets "hg".
            pages.wanted += resident * kilobyte;
            pages.got += huge * kilobyte;
        }
    }
}

HugePages huge_pages() {
    HugePages pages;
    pages.policy = chosen_word(text_of(policy_file));
    pages.forbidden = prctl(PR_GET_THP_DISABLE, 0, 0, 0, 0) == 1;
    count_huge_pages(text_of("/proc/self/smaps"), pages);
    return pages;
}

std::string huge_page_notice(const HugePages& pages) {
    const std::string slower = "; matching works the same, a little slower";
    if (pages.policy.empty()) {
        return "no huge pages: this kernel has none" + slower;
    }
    // The pages that nobody has written to yet are missing.
    if (pages.got >= pages.wanted / 10 * 9) {
        return {};
    }
    if (pages.policy == "never") {
        return fmt::format("no huge pages: {} says never, allowed: madvise or always{}", policy_file, slower);
    }
    if (pages.forbidden) {
        return "no huge pages: they are forbidden to this process (PR_SET_THP_DISABLE)" + slower;
    }
    return fmt::format("huge pages for {} of {} MB: the system had no more free memory in one piece{}",
                       megabytes(pages.got), megabytes(pages.wanted), slower);
}

}  // namespace disparityd::daemon
