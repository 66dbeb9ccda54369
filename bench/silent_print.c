/* Preloaded into rs274: its canonical output costs nothing, so that reading is compared with reading. */
#include <stdarg.h>
#include <stdio.h>

int fprintf(FILE* stream, const char* format, ...) { (void)stream; (void)format; return 0; }
int __fprintf_chk(FILE* stream, int flag, const char* format, ...) { (void)stream; (void)flag; (void)format; return 0; }
int printf(const char* format, ...) { (void)format; return 0; }
int __printf_chk(int flag, const char* format, ...) { (void)flag; (void)format; return 0; }
int vfprintf(FILE* stream, const char* format, va_list arguments) { (void)stream; (void)format; (void)arguments; return 0; }
