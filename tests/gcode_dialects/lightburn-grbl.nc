; LightBurn 1.4.05
; GRBL device profile, absolute coords
; Bounds: X20 Y20 to X80 Y60
G00 G17 G40 G21 G54
G90
M4
; Cut @ 1200 mm/min, 50% power
M8
G0 X20Y20
; Layer C00
G1 X80Y20S500F1200
G1 Y60
G1 X20
G1 Y20
G0 X30Y40
G2 X50Y40I10J0
G2 X30Y40I-10J0
M9
G1 S0
M5
G90
; return to user-defined finish pos
G0 X0Y0
M2
