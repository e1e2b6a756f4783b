// Shared by the C++ peers: reading and writing doubles, the clock, the report.
#pragma once
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

inline std::vector<double> read_doubles(const char* path) {
    std::FILE* file = std::fopen(path, "rb");
    if (!file) { std::perror(path); std::exit(3); }
    std::fseek(file, 0, SEEK_END);
    std::vector<double> out(std::ftell(file) / 8);
    std::rewind(file);
    if (std::fread(out.data(), 8, out.size(), file) != out.size()) std::exit(4);
    std::fclose(file);
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("BASE %.1f\n", usage.ru_maxrss / 1024.0);
    return out;
}

inline void write_doubles(const char* path, const std::vector<double>& v) {
    std::FILE* file = std::fopen(path, "wb");
    if (!file || std::fwrite(v.data(), 8, v.size(), file) != v.size()) std::exit(5);
    std::fclose(file);
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("RSS %.1f\n", usage.ru_maxrss / 1024.0);
}

template <class F>
void timed(int repetitions, int inner, F run) {
    for (int k = 0; k <= repetitions; k++) {
        auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < inner; i++) run();
        std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        if (k) std::printf("T %.9f\n", took.count() / inner);
    }
}
