// A plugin from another world.
extern "C" const char* kestrelPluginStamp() { return "kestrel 0.0.1, headers 0"; }
extern "C" void kestrelPluginRegister(void*) { __builtin_trap(); }
