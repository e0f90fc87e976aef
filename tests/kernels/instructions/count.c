/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A plugin of QEMU (user mode, plugin interface version 1): counts the instructions that the emulated program executes,
 * for each function by its symbol, and writes lines "NUMBER SYMBOL" to the file of the argument out=FILE. Debian has no
 * header of the interface, so that the few functions used are declared here, as QEMU's documentation has them
 * (docs/devel/tcg-plugins.rst).
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum { QEMU_PLUGIN_INLINE_ADD_U64 = 0 };

void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*translated)(qemu_plugin_id_t, struct qemu_plugin_tb*));
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb* block, int operation, void* at, uint64_t value);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, void (*at_exit)(qemu_plugin_id_t, void*), void* data);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb* block);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb* block, size_t index);
const char* qemu_plugin_insn_symbol(const struct qemu_plugin_insn* instruction);

int qemu_plugin_version = 1;

/* One entry for each symbol; a symbol is known by its pointer, which QEMU keeps. The sums are exact for a program of
 * one thread: threads do not add atomically. What finds no entry goes to the last one. */
enum { max_functions = 16384 };
static struct {
    const char* symbol;
    uint64_t executed;
} functions[max_functions];
static char out[4096];

static uint64_t* counter_of(const char* symbol) {
    size_t i = (size_t)((uintptr_t)symbol / 4 % (max_functions - 1));
    size_t tried;
    for (tried = 0; tried < max_functions - 1; ++tried, i = (i + 1) % (max_functions - 1)) {
        if (functions[i].symbol == NULL) {
            functions[i].symbol = symbol;
        }
        if (functions[i].symbol == symbol) {
            return &functions[i].executed;
        }
    }
    return &functions[max_functions - 1].executed;
}

static void on_translated(qemu_plugin_id_t id, struct qemu_plugin_tb* block) {
    const char* symbol = qemu_plugin_insn_symbol(qemu_plugin_tb_get_insn(block, 0));
    (void)id;
    qemu_plugin_register_vcpu_tb_exec_inline(
        block, QEMU_PLUGIN_INLINE_ADD_U64, symbol == NULL ? &functions[max_functions - 1].executed : counter_of(symbol),
        qemu_plugin_tb_n_insns(block));
}

static void on_exit_of_program(qemu_plugin_id_t id, void* data) {
    FILE* file = fopen(out, "w");
    size_t i;
    (void)id;
    (void)data;
    if (file == NULL) {
        return;
    }
    for (i = 0; i < max_functions; ++i) {
        if (functions[i].executed != 0) {
            fprintf(file, "%" PRIu64 " %s\n", functions[i].executed,
                    functions[i].symbol == NULL ? "?" : functions[i].symbol);
        }
    }
    fclose(file);
}

int qemu_plugin_install(qemu_plugin_id_t id, const void* info, int argc, char** argv) {
    (void)info;
    if (argc != 1 || strncmp(argv[0], "out=", 4) != 0 || strlen(argv[0] + 4) >= sizeof out) {
        fprintf(stderr, "count: the plugin takes one argument, out=FILE\n");
        return -1;
    }
    strcpy(out, argv[0] + 4);
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translated);
    qemu_plugin_register_atexit_cb(id, on_exit_of_program, NULL);
    return 0;
}
