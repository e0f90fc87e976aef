// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace disparityd::daemon {

/// What the system gives the memory of this process that asks for huge pages (LargeBuffer does).
struct HugePages {
    std::string policy;      ///< the chosen word of /sys/kernel/mm/transparent_hugepage/enabled; empty: there is none
    bool forbidden = false;  ///< to this process, by prctl(PR_SET_THP_DISABLE)
    std::size_t wanted = 0;  ///< bytes in use of the memory that asked
    std::size_t got = 0;     ///< bytes of these in huge pages
};

/// Asks the system, which walks through the memory of the process: too slow for every status.
HugePages huge_pages();

/// Returns one line for people when matching uses small pages; empty when all is well.
std::string huge_page_notice(const HugePages& pages);

/// Returns the chosen word of a text such as "always [madvise] never"; empty when there is none.
std::string chosen_word(const std::string& text);

/// Fills in wanted and got from the text of /proc/self/smaps.
void count_huge_pages(const std::string& smaps, HugePages& pages);

}  // namespace disparityd::daemon
