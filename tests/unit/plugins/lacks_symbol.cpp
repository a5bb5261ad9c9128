// A library that does not load: nobody has this function.
extern "C" int kestrelTestSymbolThatNobodyHas();
extern "C" int answer() { return kestrelTestSymbolThatNobodyHas(); }
