RATE = 2.0
print(f"{RATE} Hz")
