; Inno Setup 6 makes the installer of the folder that `python packaging/bundle.py` has made:
;   iscc /DVersion=0.1.0 packaging\windows\kirigami-studio.iss
; Signed, with a certificate in the store of Windows (quotes as Inno Setup wants them):
;   iscc /DVersion=0.1.0 /DSigned "/Ssigntool=signtool.exe sign /a /fd sha256 /tr http://timestamp.digicert.com /td sha256 $f" packaging\windows\kirigami-studio.iss
#ifndef Version
  #error Give the version: /DVersion=...
#endif
#ifndef Machine
  #define Machine "x86_64"
#endif

[Setup]
AppId={{6B0B5F0E-5A0C-4C57-9D53-0C9E6C1B7C11}
AppName=Kirigami Studio
AppVersion={#Version}
AppPublisher=Kirigami Studio contributors
DefaultDirName={autopf}\Kirigami Studio
DefaultGroupName=Kirigami Studio
DisableProgramGroupPage=yes
PrivilegesRequired=lowest
PrivilegesRequiredOverridesAllowed=dialog
ArchitecturesAllowed=x64compatible
ArchitecturesInstallIn64BitMode=x64compatible
MinVersion=10.0.17763
LicenseFile=..\..\LICENSE
SetupIconFile=..\..\build\icons\kirigami-studio.ico
UninstallDisplayIcon={app}\kirigami-studio-window.exe
OutputDir=..\..\dist
OutputBaseFilename=kirigami-studio-{#Version}-windows-{#Machine}-setup
Compression=lzma2/max
SolidCompression=yes
WizardStyle=modern
ChangesAssociations=yes
#ifdef Signed
SignTool=signtool
SignedUninstaller=yes
#endif

[Languages]
Name: "en"; MessagesFile: "compiler:Default.isl"
Name: "de"; MessagesFile: "compiler:Languages\German.isl"

[Tasks]
Name: "desktopicon"; Description: "{cm:CreateDesktopIcon}"; Flags: unchecked

[InstallDelete]
; Files of an older version must not stay among the new ones.
Type: filesandordirs; Name: "{app}\_internal"

[Files]
#ifdef Signed
Source: "..\..\build\bundle\dist\kirigami-studio\*.exe"; DestDir: "{app}"; Flags: ignoreversion sign
#else
Source: "..\..\build\bundle\dist\kirigami-studio\*.exe"; DestDir: "{app}"; Flags: ignoreversion
#endif
Source: "..\..\build\bundle\dist\kirigami-studio\_internal\*"; DestDir: "{app}\_internal"; Flags: ignoreversion recursesubdirs createallsubdirs

[Icons]
Name: "{autoprograms}\Kirigami Studio"; Filename: "{app}\kirigami-studio-window.exe"
Name: "{autodesktop}\Kirigami Studio"; Filename: "{app}\kirigami-studio-window.exe"; Tasks: desktopicon

[Registry]
Root: HKA; Subkey: "Software\Classes\.kiri"; ValueType: string; ValueName: ""; ValueData: "KirigamiStudio.Project"; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.kiri"; ValueType: string; ValueName: "Content Type"; ValueData: "application/x-kirigami-studio"; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\KirigamiStudio.Project"; ValueType: string; ValueName: ""; ValueData: "Kirigami Studio project"; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\KirigamiStudio.Project\DefaultIcon"; ValueType: string; ValueName: ""; ValueData: "{app}\kirigami-studio-window.exe,0"
Root: HKA; Subkey: "Software\Classes\KirigamiStudio.Project\shell\open\command"; ValueType: string; ValueName: ""; ValueData: """{app}\kirigami-studio-window.exe"" ""%1"""

[Run]
Filename: "{app}\kirigami-studio-window.exe"; Description: "{cm:LaunchProgram,Kirigami Studio}"; Flags: nowait postinstall skipifsilent
